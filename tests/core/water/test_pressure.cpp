// Forces of water on faces and in pores, against integrals over many small parts.
#include <vector>

#include "core/water/pressure.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// p = 2 - x + 3 y - z, twice; then dry.
const Real rows[] = {2, -1, 3, -1, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
Real pressure_at(const Vec& x) { return 2 * std::max(0.0, 2 - x.x + 3 * x.y - x.z); }

template <Index count>
struct Pressed {
  Vec x[count], force[count];
  Index field[count] = {};

  void press() {
    std::vector<Real> motion(8 * count), kept(count), out(4 * count);
    std::vector<Index> nodes(count);
    for (Index k = 0; k < count; ++k) put(motion.data() + 8 * k, x[k]), nodes[k] = k;
    PressOnFaces<count>{.nodes = {motion.data()},
                        .face_nodes = {nodes.data(), 1},
                        .field = {field, 1},
                        .kept = {kept.data(), 1},
                        .fields = {rows},
                        .out = {out.data()}}(One{0});
    for (Index k = 0; k < count; ++k) force[k] = vector_at(out.data() + 4 * k);
  }
};

/// -int p n N_k dA of a triangle by many middles of parts.
Vec by_parts(const Vec* x, Index corner) {
  constexpr Index n = 400;
  const Vec area = Real(0.5 / (n * n)) * cross(x[1] - x[0], x[2] - x[0]);
  Real sum = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n - i; ++j)
      for (const Real shift : {1.0 / 3, 2.0 / 3}) {
        if (shift > 0.5 && j == n - i - 1) continue;
        const Real b = (i + shift) / n, c = (j + shift) / n;
        const Real value[3] = {1 - b - c, b, c};
        sum += value[corner] * pressure_at(value[0] * x[0] + b * x[1] + c * x[2]);
      }
  return -sum * area;
}

}  // namespace

TEST_CASE("a triangle that is wet, partly wet or dry feels the pressure that its place has") {
  Random random(1);
  int partly = 0;
  for (int round = 0; round < 60; ++round) {
    Pressed<3> face;
    for (Vec& x : face.x) x = random.vector(1.5);
    face.press();
    int wet = 0;
    for (const Vec& x : face.x) wet += pressure_at(x) > 0;
    partly += wet == 1 || wet == 2;
    const Real size = norm(cross(face.x[1] - face.x[0], face.x[2] - face.x[0]));
    for (Index k = 0; k < 3; ++k) CHECK(distance(face.force[k], by_parts(face.x, k)) < 2e-4 * size);
  }
  CHECK(partly > 20);
}

TEST_CASE("a vertex at which the pressure just ends takes no part") {
  Pressed<3> face;
  face.x[0] = {0, 0, 0}, face.x[1] = {2, 0, 0}, face.x[2] = {0, 0, 2};
  face.press();  // pressures 4, 0, 0; the normal is -y, twice the area 4
  CHECK(distance(face.force[0], Vec{0, 4.0 / 24 * 8, 0}) < 1e-14);
  CHECK(distance(face.force[1], Vec{0, 4.0 / 24 * 4, 0}) < 1e-14);
  CHECK(distance(face.force[2], face.force[1]) < 1e-14);
}

TEST_CASE("a quadrilateral: exact where it is wet, close where the water ends inside") {
  Random random(2);
  for (int round = 0; round < 40; ++round) {
    Pressed<4> face;
    const Vec a = random.vector(1), b = random.vector(1), corner = random.vector(0.6);
    face.x[0] = corner, face.x[1] = corner + a, face.x[2] = corner + a + b, face.x[3] = corner + b;
    face.press();
    Vec sum{0, 0, 0}, exact{0, 0, 0};
    bool whole = true;
    for (Index k = 0; k < 4; ++k) sum = sum + face.force[k], whole &= pressure_at(face.x[k]) > 0;
    const Vec halves[2][3] = {{face.x[0], face.x[1], face.x[2]}, {face.x[0], face.x[2], face.x[3]}};
    for (const Vec(&half)[3] : halves)
      for (Index k = 0; k < 3; ++k) exact = exact + by_parts(half, k);
    CHECK(distance(sum, exact) < (whole ? 1e-4 : 2e-2) * norm(cross(a, b)));
  }
}

TEST_CASE("forces on a quadrilateral that is wet all over turn about its true centre of pressure") {
  Pressed<4> face;
  face.x[0] = {0, 0, 0}, face.x[1] = {1, 0, 0}, face.x[2] = {1, 1, 0}, face.x[3] = {0, 1, 0};
  face.press();  // p = 4 - 2 x + 6 y: sum 6, moments of x and y 2 - 2/3 + 3/2 and 2 - 1/2 + 2
  Vec sum{0, 0, 0};
  Real mx = 0, my = 0;
  for (Index k = 0; k < 4; ++k) {
    sum = sum + face.force[k];
    mx += face.x[k].x * face.force[k].z, my += face.x[k].y * face.force[k].z;
  }
  CHECK(sum.z == doctest::Approx(-6).epsilon(1e-14));
  CHECK(mx == doctest::Approx(-(2 - 2.0 / 3 + 1.5)).epsilon(1e-14));
  CHECK(my == doctest::Approx(-(2 - 0.5 + 2)).epsilon(1e-14));
}

TEST_CASE("a dry vertex has no pressure wherever it is") {
  Pressed<3> face;
  face.x[0] = {0, 0, 0}, face.x[1] = {1, 0, 0}, face.x[2] = {0, 1, 0};
  for (Index& field : face.field) field = 1;
  face.press();
  for (const Vec& f : face.force) CHECK(norm(f) == 0);
}

TEST_CASE("lanes of faces have the bits of single ones") {
  Random random(3);
  constexpr Index count = 4 * lanes;
  std::vector<Real> motion(8 * 4 * count), kept(4 * count), one(16 * count), many(16 * count);
  std::vector<Index> nodes(4 * count), field(4 * count);
  for (Index i = 0; i < 4 * count; ++i) {
    put(motion.data() + 8 * i, random.vector(2));
    nodes[i] = i, field[i] = random.below(6) == 0, kept[i] = random.between(-1, 1);
  }
  const auto check = [&]<Index corners>() {
    PressOnFaces<corners> kernel{.nodes = {motion.data()},
                                 .face_nodes = {nodes.data(), count},
                                 .field = {field.data(), count},
                                 .kept = {kept.data(), count},
                                 .fields = {rows},
                                 .out = {one.data()}};
    for (Index f = 0; f < count; ++f) kernel(One{f});
    kernel.out.rows = many.data();
    for (Index f = 0; f < count; f += lanes) kernel(Lane{f});
    int differ = 0;
    for (Index f = 0; f < corners * count; ++f)
      for (Index k = 0; k < 3; ++k) differ += !same_bits(one[4 * f + k], many[4 * f + k]);
    CHECK(differ == 0);
  };
  check.operator()<3>();
  check.operator()<4>();
}

}  // namespace cdem::test
