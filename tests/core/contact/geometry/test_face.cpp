// Frame of a face, inside test, projection of a point.
#include "core/contact/geometry/face.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// A triangle or quadrilateral of about 1 m, anywhere; a quadrilateral is warped by so much  [m].
FaceShape<Real> random_face(Random& random, bool quad, Real warp) {
  const Mat turn = random.rotation();
  const Vec at = random.vector(5);
  const auto corner = [&](Real x, Real y) {
    return at + turn * Vec{x + random.between(-0.2, 0.2), y + random.between(-0.2, 0.2),
                           random.between(-warp, warp)};
  };
  FaceShape<Real> f{{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)}, quad};
  if (!quad) f.x[3] = f.x[2];
  return f;
}

/// Nine numbers for three corners and more, as check_lanes wants them.
template <class T>
FaceShape<T> face_at(const T* in) {
  return {{vector_at(in), vector_at(in + 3), vector_at(in + 6), vector_at(in + 9)},
          in[12] > T(0.5)};
}

Vec weighted(const FaceShape<Real>& f, const Projection<Real>& p) {
  Vec sum{0, 0, 0};
  for (Index j = 0; j < 4; ++j) sum = sum + p.weight[j] * f.x[j];
  return sum;
}

}  // namespace

TEST_CASE("the normal of a face points to where its corners run counter-clockwise") {
  const FaceShape<Real> quad{{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, true};
  const FaceShape<Real> triangle{{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 1, 0}}, false};
  for (const FaceShape<Real>& f : {quad, triangle}) {
    CHECK(distance(f.normal(), Vec{0, 0, 1}) == 0);
    CHECK(distance(f.frame().t1, Vec{1, 0, 0}) == 0);
    CHECK(distance(f.frame().t2, Vec{0, 1, 0}) == 0);
  }
  CHECK(distance(quad.center(), Vec{1, 0.5, 0}) == 0);
  CHECK(distance(triangle.center(), Vec{2.0 / 3, 1.0 / 3, 0}) < 1e-15);
  CHECK(quad.count() == 4);
  CHECK(triangle.count() == 3);
}

TEST_CASE("a frame is orthonormal and right-handed") {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const Frame<Real> f = random_face(random, k % 2, 0.2).frame();
    CHECK(distance(Mat{f.n, f.t1, f.t2} * transpose(Mat{f.n, f.t1, f.t2}), identity<Real>()) <
          3e-15);
    CHECK(distance(cross(f.n, f.t1), f.t2) < 1e-14);
  }
}

TEST_CASE("a point is its projection and its gap along the normal") {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    const FaceShape<Real> f = random_face(random, k % 2, 0.05);
    const Vec n = f.normal(), point = f.center() + random.vector(0.4);
    const Projection<Real> p = project(f, point, n);
    CHECK(std::abs(p.weight[0] + p.weight[1] + p.weight[2] + p.weight[3] - 1) < 1e-15);
    CHECK(distance(weighted(f, p) + p.gap * n, point) < 1e-14);
    if (!f.quad) CHECK(p.weight[3] == 0);
  }
}

TEST_CASE("a corner projects onto itself, the centre of a parallelogram onto all alike") {
  Random random(3);
  for (int k = 0; k < 100; ++k) {
    FaceShape<Real> f = random_face(random, k % 2, 0);
    for (Index j = 0; j < f.count(); ++j) {
      const Projection<Real> p = project(f, f.x[j], f.normal());
      CHECK(std::abs(p.weight[j] - 1) < 2e-15);
      CHECK(std::abs(p.gap) < 1e-15);
    }
    if (!f.quad) continue;
    f.x[2] = f.x[1] + f.x[3] - f.x[0];
    for (const Real w : project(f, f.center() + f.normal(), f.normal()).weight)
      CHECK(std::abs(w - 0.25) < 2e-15);
  }
}

TEST_CASE("inside means a projection between the corners, or outside by less than the room") {
  Random random(4);
  int insides = 0;
  for (int k = 0; k < 2000; ++k) {
    const FaceShape<Real> f = random_face(random, k % 2, 0);
    const Vec n = f.normal(), point = f.center() + random.vector(0.7);
    const Projection<Real> p = project(f, point, n);
    const bool inside = *std::min_element(p.weight, p.weight + f.count()) > 0;
    CHECK(bool(f.inside(point, n, 0.0)) == inside);
    insides += inside;
    if (!inside) continue;
    CHECK(f.inside(point, n, 0.1));
    // across the first side, by less and by more than the room
    const Vec side = f.x[1] - f.x[0], out = unit(cross(side, n)), middle = f.x[0] + 0.5 * side;
    CHECK(f.inside(middle + Real(0.009) * out, n, 0.01));
    CHECK(!f.inside(middle + Real(0.011) * out, n, 0.01));
  }
  CHECK(insides > 500);
}

TEST_CASE("faces of packs are those of their numbers, triangles beside quadrilaterals") {
  Random random(5);
  const auto draw = [&](Real* in) {
    const FaceShape<Real> f = random_face(random, random.below(2), 0.1);
    for (Index j = 0; j < 4; ++j) put(in + 3 * j, f.x[j]);
    in[12] = f.quad;
    put(in + 13, f.center() + random.vector(0.5));
  };
  check_lanes<16, 18>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const FaceShape<T> f = face_at(in);
        const Frame<T> frame = f.frame();
        put(out, frame.n);
        put(out + 3, frame.t1);
        put(out + 6, frame.t2);
        put(out + 9, f.center());
        const Projection<T> p = project(f, vector_at(in + 13), frame.n);
        for (Index j = 0; j < 4; ++j) out[12 + j] = p.weight[j];
        out[16] = p.gap;
        out[17] = select(f.inside(vector_at(in + 13), frame.n, T(0.01)), T(1.0), T(0.0));
      },
      draw);
}

}  // namespace cdem::test
