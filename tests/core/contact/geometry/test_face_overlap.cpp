// The area that two faces have in common.
#include "core/contact/geometry/face_overlap.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

constexpr Real far_off = 1e9;

/// A rectangle of the plane z = 0 from one corner to another, seen from above or from below.
FaceShape<Real> rectangle(Real x0, Real y0, Real x1, Real y1, bool from_above) {
  FaceShape<Real> f{{{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}}, true};
  if (!from_above) std::swap(f.x[1], f.x[3]);
  return f;
}

FaceShape<Real> moved(FaceShape<Real> f, const Mat& turn, const Vec& by) {
  for (Vec& x : f.x) x = by + turn * x;
  return f;
}

}  // namespace

TEST_CASE("faces that lie on each other share what their outlines do, wherever they are") {
  Random random(71);
  const FaceShape<Real> floor = rectangle(0, 0, 3, 2, true);
  for (int k = 0; k < 50; ++k) {
    const Mat turn = random.rotation();
    const Vec by = random.vector(3);
    const auto area = [&](Real x0, Real y0, Real x1, Real y1) {
      const FaceShape<Real> a = moved(rectangle(x0, y0, x1, y1, false), turn, by),
                            b = moved(floor, turn, by);
      const Real once = FaceOverlap(a, b).area(-far_off, far_off);
      CHECK(std::abs(FaceOverlap(b, a).area(-far_off, far_off) - once) < 1e-12);
      return once;
    };
    CHECK(std::abs(area(1, 0.5, 2, 1.5) - 1) < 1e-12);        // inside
    CHECK(std::abs(area(2.5, -1, 4, 0.25) - 0.125) < 1e-12);  // at a corner
    CHECK(std::abs(area(-1, 0.5, 4, 0.75) - 0.75) < 1e-12);   // across
    CHECK(std::abs(area(-1, -1, 4, 3) - 6) < 1e-12);          // all of it
    CHECK(std::abs(area(5, 0, 6, 1)) < 1e-12);                // beside
  }
}

TEST_CASE("a triangle, and a square that is turned by 45 degrees") {
  const FaceShape<Real> floor = rectangle(-1, -1, 1, 1, true);
  const FaceShape<Real> triangle{{{0, 0, 0}, {0, 2, 0}, {2, 0, 0}, {2, 0, 0}}, false};
  CHECK(std::abs(FaceOverlap(triangle, floor).area(-far_off, far_off) - 1) < 1e-14);
  CHECK(std::abs(FaceOverlap(floor, triangle).area(-far_off, far_off) - 1) < 1e-14);
  const Real r = std::sqrt(2.0);  // an octagon is left
  const FaceShape<Real> turned{{{0, -r, 0}, {-r, 0, 0}, {0, r, 0}, {r, 0, 0}}, true};
  CHECK(std::abs(FaceOverlap(turned, floor).area(-far_off, far_off) - 8 * (r - 1)) < 1e-12);
}

TEST_CASE("a face that is tilted is near along a strip, and deep along another") {
  const FaceShape<Real> floor = rectangle(0, 0, 2, 1, true);
  FaceShape<Real> lid = rectangle(0, 0, 2, 1, false);
  const Real slope = 1e-3;
  for (Vec& x : lid.x) x.z = slope * (x.x - 1);  // from -1 to 1 mm
  CHECK(relative_error(FaceOverlap(lid, floor).area(-far_off, far_off), 2) < 1e-6);
  CHECK(relative_error(FaceOverlap(lid, floor).area(-far_off, 0), 1) < 1e-6);
  CHECK(relative_error(FaceOverlap(lid, floor).area(-far_off, 0.5e-3), 1.5) < 1e-6);
  CHECK(relative_error(FaceOverlap(lid, floor).area(-0.5e-3, 0.5e-3), 1) < 1e-6);
  CHECK(relative_error(FaceOverlap(floor, lid).area(-0.5e-3, 0.5e-3), 1) < 1e-6);
  CHECK(FaceOverlap(lid, floor).area(1.5e-3, 2e-3) == 0);
}

}  // namespace cdem::test
