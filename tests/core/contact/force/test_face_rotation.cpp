// The rotation of a face by least squares, and couples on it.
#include "core/contact/force/face_rotation.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

Vec random_vector(Random& random, Real size) {
  return {random.between(-size, size), random.between(-size, size), random.between(-size, size)};
}

FaceShape<Real> random_face(Random& random, bool quad) {
  FaceShape<Real> f{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, quad};
  for (Vec& x : f.x) x = x + random_vector(random, 0.2);
  if (!quad) f.x[3] = f.x[2];
  return f;
}

}  // namespace

TEST_CASE("a rigid rotation seen from the middle of a step is 2 tan(a / 2), whatever the face") {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    const FaceShape<Real> before = random_face(random, round % 2);
    const Vec spin = random_vector(random, 0.5), shift = random_vector(random, 1);
    // (1 - S / 2)^-1 (1 + S / 2), Cayley: the rotation by 2 atan(|spin| / 2)
    const Mat s{{0, -spin.z, spin.y}, {spin.z, 0, -spin.x}, {-spin.y, spin.x, 0}};
    const Mat turn = inverse(identity<Real>() - 0.5 * s) * (identity<Real>() + 0.5 * s);
    FaceShape<Real> middle = before;
    Vec moved[4];
    for (Index j = 0; j < 4; ++j) {
      moved[j] = turn * before.x[j] + shift - before.x[j];
      middle.x[j] = before.x[j] + 0.5 * moved[j];
    }
    CHECK(distance(FaceRotation::of(middle).turned(moved), spin) < 1e-12);
  }
}

TEST_CASE("forces of a couple sum to nothing, have its moment, and do its work") {
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    const FaceShape<Real> shape = random_face(random, round % 2);
    const FaceRotation face = FaceRotation::of(shape);
    const Vec couple = random_vector(random, 1);
    Vec force{0, 0, 0}, moment{0, 0, 0}, moved[4];
    Real work = 0;
    for (Index j = 0; j < face.count; ++j) {
      const Vec f = face.force(j, couple);
      moved[j] = random_vector(random, 1);
      force = force + f;
      moment = moment + cross(shape.x[j], f);
      work += dot(f, moved[j]);
    }
    CHECK(norm(force) < 1e-13);
    CHECK(distance(moment, couple) < 1e-12);
    CHECK(std::abs(work - dot(couple, face.turned(moved))) < 1e-12);
  }
}

TEST_CASE("a rotation spring of K times the lever is no stiffer on the vertices than K") {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const FaceRotation face = FaceRotation::of(random_face(random, round % 2));
    // power of the spring against any motion of unit length
    for (int k = 0; k < 20; ++k) {
      Vec moved[4];
      Real size = 0;
      for (Index j = 0; j < face.count; ++j) {
        moved[j] = cross(random_vector(random, 1), face.arm[j]);
        size += dot(moved[j], moved[j]);
      }
      const Vec turn = face.turned(moved);
      CHECK(face.lever_squared() * dot(turn, turn) < size * (1 + 1e-12));
    }
  }
  const Real r = 0.3, h = r * std::sqrt(0.75);
  const Vec tip{0.5 * r, h, 0};
  const FaceShape<Real> regular{{{-r, 0, 0}, {0.5 * r, -h, 0}, tip, tip}, false};
  CHECK(relative_error(FaceRotation::of(regular).lever_squared(), r * r) < 1e-14);
}

}  // namespace cdem::test
