// Surface laws at the vertices of faces.
#include <vector>

#include "core/surface/act_on_faces.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Pulls back to where the face lay, until it has been drawn farther than its reach.
template <class T>
struct Tether {
  static constexpr LawText text{.name = "tether", .meaning = "A spring that can be lost"};
  static constexpr std::array parameters{
      Parameter{.name = "stiffness", .symbol = "k", .unit = "Pa/m", .meaning = "Stiffness"},
      Parameter{.name = "reach", .symbol = "r", .unit = "m", .meaning = "Reach"}};
  static constexpr std::array state{StateVariable{.name = "lost", .unit = "1", .meaning = "1"}};
  T stiffness, reach;
  CDEM_HD static Tether read(const auto& number) { return {number(0), number(1)}; }
  CDEM_HD Vec3<T> respond(const SurfacePoint<T>& at, T* lost) const {
    const T one(1.0), none(0.0);
    *lost = select(norm(at.displacement) > reach, one, *lost);
    return (-select(*lost > none, none, stiffness)) * at.displacement;
  }
};
using TestedLaws = LawList<Pressure, Tether>;

/// Faces anywhere, each of an entry of its own.
template <Index count>
struct AnyFaces {
  static constexpr Index faces = 25, nodes = count * faces;  // and one is left over
  static constexpr Index stride = 32;
  std::vector<Real> motion = std::vector<Real>(8 * nodes), place, state;
  std::vector<Index> face_nodes = std::vector<Index>(count * stride),
                     entry = std::vector<Index>(stride);
  std::vector<Index> law = std::vector<Index>(stride);
  std::vector<Real> parameters = std::vector<Real>(surface_row * stride),
                    factor = std::vector<Real>(stride, 1), acts = std::vector<Real>(stride, 1);
  std::vector<Real> force = std::vector<Real>(4 * count * stride);

  explicit AnyFaces(std::uint64_t seed) : place(3 * count * stride), state(count * stride) {
    Random random(seed);
    for (Real& x : motion) x = random.between(-1, 1);
    for (Index f = 0; f < faces; ++f) {
      entry[f] = f, law[f] = f % 2, factor[f] = random.between(-1, 2), acts[f] = f % 5 > 0;
      parameters[surface_row * f] = random.between(1, 2);
      parameters[surface_row * f + 1] = random.between(0, 3);
      for (Index k = 0; k < count; ++k) {
        face_nodes[k * stride + f] = count * f + k;
        for (Index axis = 0; axis < 3; ++axis)
          place[(3 * k + axis) * stride + f] = random.between(-1, 1);
      }
    }
  }
  ActOnFaces<TestedLaws, count> kernel() {
    return {.nodes = {motion.data()},
            .face_nodes = {face_nodes.data(), stride},
            .entry = {entry.data(), stride},
            .entries = {law.data(), parameters.data(), factor.data(), acts.data()},
            .place = {place.data(), stride},
            .state = {state.data(), stride},
            .out = {force.data()}};
  }
  void act() {
    for (Index f = 0; f < faces; ++f) kernel()(One{f});
  }
  Vec position(Index f, Index k) const { return vector_at(motion.data() + 8 * (count * f + k)); }
  Vec sum(Index f) const {
    Vec all{0, 0, 0};
    for (Index k = 0; k < count; ++k) all = all + vector_at(force.data() + 4 * (count * f + k));
    return all;
  }
};

}  // namespace

TEST_CASE("a pressure on a face sums to pressure times its area as a vector, flat or not") {
  AnyFaces<3> triangles(1);
  AnyFaces<4> quads(2);
  triangles.act();
  quads.act();
  for (Index f = 0; f < AnyFaces<3>::faces; ++f) {
    if (triangles.law[f] != 0) continue;
    const Real p = triangles.acts[f] * triangles.factor[f] * triangles.parameters[surface_row * f];
    const Vec a = triangles.position(f, 0), b = triangles.position(f, 1),
              c = triangles.position(f, 2);
    CHECK(distance(triangles.sum(f), (-0.5 * p) * cross(b - a, c - a)) < 1e-14);
    const Vec x = quads.position(f, 0), y = quads.position(f, 1), z = quads.position(f, 2),
              w = quads.position(f, 3);
    const Real q = quads.acts[f] * quads.factor[f] * quads.parameters[surface_row * f];
    CHECK(distance(quads.sum(f), (-0.5 * q) * cross(z - x, w - y)) < 1e-14);
  }
}

TEST_CASE("an entry that waits neither acts nor remembers; state is kept by vertex") {
  AnyFaces<4> faces(3);
  faces.act();
  Index lost = 0, held = 0;
  for (Index f = 0; f < AnyFaces<4>::faces; ++f)
    for (Index k = 0; k < 4; ++k) {
      const Vec start{faces.place[3 * k * AnyFaces<4>::stride + f],
                      faces.place[(3 * k + 1) * AnyFaces<4>::stride + f],
                      faces.place[(3 * k + 2) * AnyFaces<4>::stride + f]};
      const Vec moved = faces.position(f, k) - start;
      const bool is_lost = faces.law[f] == 1 && faces.acts[f] > 0 &&
                           norm(moved) > faces.parameters[surface_row * f + 1];
      CHECK(faces.state[k * AnyFaces<4>::stride + f] == (is_lost ? 1 : 0));
      const Vec force = vector_at(faces.force.data() + 4 * (4 * f + k));
      if (faces.acts[f] == 0 || is_lost) CHECK(norm(force) == 0);
      if (faces.law[f] == 1 && faces.acts[f] > 0 && !is_lost) {
        CHECK(dot(force, moved) < 0);
        CHECK(norm(cross(force, moved)) < 1e-14);
      }
      lost += is_lost, held += faces.law[f] == 1 && faces.acts[f] > 0 && !is_lost;
    }
  CHECK(lost > 5);
  CHECK(held > 5);
}

TEST_CASE("packs of faces give the bits of one after the other, forces and state") {
  AnyFaces<3> one(4), many(4);
  one.act();
  for (Index f = 0; f + lanes <= AnyFaces<3>::faces; f += lanes) many.kernel()(Lane{f});
  many.kernel()(One{AnyFaces<3>::faces - 1});
  int differ = 0;
  for (std::size_t k = 0; k < 12 * std::size_t(AnyFaces<3>::faces); ++k)
    differ += !same_bits(one.force[k], many.force[k]);
  CHECK(differ == 0);
  CHECK(one.state == many.state);
}

}  // namespace cdem::test
