// Pairs that hold by some of their points open as hinges.
#include "core/bonds/release.hpp"
#include "core/records/pair_status.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two boxes, bonded, of which the upper is tipped about one side of the joint by an angle.
struct Tipped : Scene {
  explicit Tipped(Real angle) {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({0, 0, 1}, {1, 1, 1});
    build();
    start();
    for (Index i = 8; i < 16; ++i) motion(i)[2] += angle * position(i).x;
    for (Index k = 0; k < 4; ++k) {
      const Index node = on_host(model.quads.nodes)[k * model.quads.stride];
      if (position(node).x > 0.5) on_host(state.quads.bond)[k * model.quads.point_stride] = 0;
    }
    on_host(state.quads.stored)[0] = 5;
  }
  PairStatus status() const { return PairStatus(on_host(state.quads.status)[0]); }
  Index intact() const {
    Index points = 0;
    for (Index k = 0; k < 4; ++k)
      points += on_host(state.quads.bond)[k * model.quads.point_stride] > 0;
    return points;
  }
  std::size_t exposed() const { return state.search.exposed_face.size(); }
};

}  // namespace

TEST_CASE("a pair that gapes by a twentieth of its length opens as a hinge, and keeps its bonds") {
  for (const Real part : {0.045, 0.055}) {
    Tipped tipped(0);
    const Real length = on_host(tipped.model.face_length)[0];
    // its points lie inside of the vertices
    const Real a = tipped.model.bond_indentation_quad, widest = part * length / (1 - a / 2);
    Tipped open(widest);
    CHECK(!release_bonds(open.model, open.state));
    CHECK(open.status() == (part > 0.05 ? PairStatus::hinge : PairStatus::bonded));
    CHECK(open.exposed() == (part > 0.05 ? 12 : 10));
    CHECK(open.intact() == 2);
  }
}

TEST_CASE("broken points of a hinge that are pressed lose their energy to friction") {
  // tipped the other way: what is pressed is as deep as the other side would gape
  Tipped pressed(-0.1);
  CHECK(!release_bonds(pressed.model, pressed.state));
  CHECK(pressed.status() == PairStatus::hinge);
  const Real stored = on_host(pressed.state.quads.stored)[0],
             friction = on_host(pressed.state.quads.friction)[0];
  CHECK(friction > 0);
  CHECK(relative_error(stored + friction, 5) < 1e-15);
  const PairSet& p = pressed.model.quads;
  const Real a = pressed.model.bond_indentation_quad, depth = 0.1 * (1 - a / 2);
  const Real k = on_host(p.stiffness)[0] * on_host(p.area)[0] / 4;
  CHECK(relative_error(friction, 2 * 0.5 * k * depth * depth) < 0.02);  // but for the tilt
}

TEST_CASE("a hinge stays one, and a pair that holds by all of its points is none") {
  Tipped whole(0.2);
  for (Index k = 0; k < 4; ++k)
    on_host(whole.state.quads.bond)[k * whole.model.quads.point_stride] = 1;
  CHECK(!release_bonds(whole.model, whole.state));
  CHECK(whole.status() == PairStatus::bonded);
  Tipped open(0.2);
  release_bonds(open.model, open.state);
  const Real friction = on_host(open.state.quads.friction)[0];
  release_bonds(open.model, open.state);
  CHECK(open.status() == PairStatus::hinge);
  CHECK(on_host(open.state.quads.friction)[0] == friction);
}

}  // namespace cdem::test
