// Vectors, matrices and symmetric tensors, and the rotation of a deformation.
#include "core/base/math.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

Mat matrix_at(const Real* list) {
  return {vector_at(list), vector_at(list + 3), vector_at(list + 6)};
}
Mat3<Pack> matrix_at(const Pack* list) {
  return {vector_at(list), vector_at(list + 3), vector_at(list + 6)};
}

/// Largest error of polar_rotation over many deformations R U of a strain.
Real error_at(Real strain) {
  Random random(3);
  Real worst = 0;
  for (int k = 0; k < 1000; ++k) {
    const Mat r = random.rotation();
    worst = std::max(worst, distance(polar_rotation(r * random.stretch(strain)), r));
  }
  return worst;
}

}  // namespace

TEST_CASE("cross and dot product") {
  const Vec x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  CHECK(distance(cross(x, y), z) == 0);
  CHECK(distance(cross(y, z), x) == 0);
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Vec a = random.vector(2), b = random.vector(2), c = cross(a, b);
    CHECK(std::abs(dot(c, a)) < 1e-14);
    CHECK(std::abs(dot(c, b)) < 5e-15);
    CHECK(relative_error(dot(c, c) + dot(a, b) * dot(a, b), dot(a, a) * dot(b, b)) < 2e-15);
  }
}

TEST_CASE("unit has length one and keeps the direction") {
  Random random(2);
  for (int k = 0; k < 100; ++k) {
    const Vec a = random.between(1e-9, 1e9) * random.direction(), u = unit(a);
    CHECK(std::abs(norm(u) - 1) < 1e-15);
    CHECK(relative_error(dot(u, a), norm(a)) < 2e-15);
  }
}

TEST_CASE("inverse, cofactor and determinant belong together") {
  Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Mat m = random.rotation() * random.stretch(0.5), c = cofactor(m);
    CHECK(distance(inverse(m) * m, identity<Real>()) < 3e-15);
    CHECK(distance(m * inverse(m), identity<Real>()) < 2e-15);
    CHECK(distance(transpose(c) * m, determinant(m) * identity<Real>()) < 2e-15);
    CHECK(relative_error(determinant(m * m), determinant(m) * determinant(m)) < 5e-15);
  }
  CHECK(determinant(Mat{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}}) == 24);
}

TEST_CASE("the product of matrices acts like one after the other") {
  Random random(4);
  for (int k = 0; k < 100; ++k) {
    const Mat a = random.matrix(1), b = random.matrix(1);
    const Vec v = random.vector(1), w = random.vector(1);
    CHECK(distance((a * b) * v, a * (b * v)) < 2e-15);
    CHECK(std::abs(dot(w, a * v) - dot(transpose(a) * w, v)) < 1e-15);
    Mat sum = a;
    add_outer(sum, v, w);
    CHECK(distance(sum * v, a * v + dot(w, v) * v) < 2e-15);
  }
}

TEST_CASE("a symmetric tensor is its full matrix") {
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const Mat m = random.matrix(1), n = random.matrix(1);
    const Sym3<Real> a = symmetric(m), b = symmetric(n);
    CHECK(distance(full(a), Real(0.5) * (m + transpose(m))) == 0);
    CHECK(trace(a) == m.r0.x + m.r1.y + m.r2.z);
    const Mat product = full(a) * full(b);
    CHECK(std::abs(contract(a, b) - (product.r0.x + product.r1.y + product.r2.z)) < 2e-15);
    const Sym3<Real> other = with_trace(a, 3.0);
    CHECK(relative_error(trace(other), 3.0) < 2e-15);
    CHECK(other.xy == a.xy);
    CHECK(std::abs(other.xx - other.yy - (a.xx - a.yy)) < 1e-15);
  }
}

TEST_CASE("polar_rotation finds R of R U: three Newton steps, so by the square of the square") {
  // reached: 5e-16, 1.2e-10, 4.7e-8, 3.0e-4
  CHECK(error_at(0.01) < 3e-15);
  CHECK(error_at(0.1) < 4e-10);
  CHECK(error_at(0.2) < 2e-7);
  CHECK(error_at(0.5) < 1e-3);
}

TEST_CASE("polar_rotation turns with the body") {
  Random random(6);
  for (int k = 0; k < 100; ++k) {
    const Mat f = random.rotation() * random.stretch(0.2), turn = random.rotation();
    CHECK(distance(polar_rotation(turn * f), turn * polar_rotation(f)) < 2e-15);
  }
}

TEST_CASE("principal axes make the tensor again, sorted, also where values are nearly equal") {
  Random random(11);
  Real worst = 0, worst_axes = 0;
  for (int k = 0; k < 3000; ++k) {
    const Real gap = k % 3 == 0 ? 0 : k % 3 == 1 ? std::pow(10, random.between(-16, -3)) : 1;
    const Vec value{1, 1 - gap * random.between(0, 1), 1 - gap * random.between(0, 1)};
    const Mat r = random.rotation();
    Mat tensor{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    add_outer(tensor, value.x * r.r0, r.r0);
    add_outer(tensor, value.y * r.r1, r.r1);
    add_outer(tensor, value.z * r.r2, r.r2);
    const PrincipalAxes<Real> found = principal_axes(symmetric(tensor));
    CHECK(found.value.x >= found.value.y);
    CHECK(found.value.y >= found.value.z);
    const Real most = std::max({value.x, value.y, value.z});
    worst = std::max(worst, std::abs(found.value.x - most));
    Mat again{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    add_outer(again, found.value.x * found.axis[0], found.axis[0]);
    add_outer(again, found.value.y * found.axis[1], found.axis[1]);
    add_outer(again, found.value.z * found.axis[2], found.axis[2]);
    worst = std::max(worst, distance(again, tensor));
    const Mat axes{found.axis[0], found.axis[1], found.axis[2]};
    worst_axes = std::max(worst_axes, distance(axes * transpose(axes), identity<Real>()));
  }
  CHECK(worst < 1e-14);
  CHECK(worst_axes < 1e-14);
}

TEST_CASE("principal axes of tensors that need no turn") {
  const auto diagonal = principal_axes(Sym3<Real>{-3, 5, 1, 0, 0, 0});
  CHECK(distance(diagonal.value, Vec{5, 1, -3}) == 0);
  CHECK(distance(diagonal.axis[0], Vec{0, 1, 0}) == 0);
  const auto none = principal_axes(Sym3<Real>{0, 0, 0, 0, 0, 0});
  CHECK(distance(none.value, Vec{0, 0, 0}) == 0);
  const auto sheared = principal_axes(Sym3<Real>{0, 0, 0, 0, 2, 0});
  CHECK(distance(sheared.value, Vec{2, 0, -2}) < 1e-15);
}

TEST_CASE("principal axes of a lane are those of its numbers") {
  Random random(12);
  check_lanes<6, 12>(
      [](const auto* in, auto* out) {
        const auto p = principal_axes(
            Sym3<std::remove_cvref_t<decltype(*in)>>{in[0], in[1], in[2], in[3], in[4], in[5]});
        put(out, p.value);
        for (int k = 0; k < 3; ++k) put(out + 3 + 3 * k, p.axis[k]);
      },
      [&](Real* in) {
        for (int k = 0; k < 6; ++k)
          in[k] = k > 2 && random.below(3) == 0 ? 0 : random.between(-1, 1);
      });
}

TEST_CASE("matrices of packs are those of their numbers") {
  Random random(7);
  check_lanes<9, 12>(
      [](const auto* in, auto* out) {
        const auto m = matrix_at(in), r = polar_rotation(m), i = inverse(m);
        put(out, r.r0);
        put(out + 3, r.r2);
        put(out + 6, i.r1);
        put(out + 9, unit(m.r0));
      },
      [&](Real* in) {
        const Mat m = random.rotation() * random.stretch(0.3);
        put(in, m.r0);
        put(in + 3, m.r1);
        put(in + 6, m.r2);
      });
}

TEST_CASE("a row is four numbers that lie together") {
  const Real memory[5] = {9, 1, 2, 3, -4};
  const Row a = Row::at(memory + 1);
  CHECK(distance(a.vector(), Vec{1, 2, 3}) == 0);
  CHECK(a.n[3] == -4);
  CHECK(a.with_size_of_last().n[3] == 4);
  CHECK(a.with_size_of_last().n[2] == 3);
  CHECK(a.xyz().n[3] == 0);
  CHECK(a.xyz().n[0] == 1);
  Real out[4];
  ((2.0 * a - Row::of(1, 1, 1)) / 2.0 + Row::zero()).store(out);
  CHECK(out[0] == 0.5);
  CHECK(out[1] == 1.5);
  CHECK(out[2] == 2.5);
  CHECK(out[3] == -4);
}

TEST_CASE("a fourth step squares the error of the rotation, at strains of 50 % too") {
  Random random(9);
  Real three = 0, four = 0;
  for (int k = 0; k < 1000; ++k) {
    const Mat r = random.rotation(), turn = random.rotation();
    const Mat stretch =
        turn * Mat{{1.5, 0, 0}, {0, random.between(0.5, 1.5), 0}, {0, 0, 0.5}} * transpose(turn);
    const Mat found = polar_rotation(r * stretch);
    three = std::max(three, distance(found, r));
    four = std::max(four, distance(nearer_rotation(found), r));
  }
  CHECK(three > 1e-6);
  CHECK(four < 2e-7);
}

}  // namespace cdem::test
