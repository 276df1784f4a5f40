// Blocks that leave the computation: what becomes of them, of their neighbours and of the energies.
#include "core/diagnostics/energy.hpp"
#include "core/nodes/time_step.hpp"
#include "core/run/take_out.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

std::vector<Flag> flags_of(const Scene& scene, Index block) {
  std::vector<Flag> leaves(scene.model.node_count);
  for (Index i = 0; i < scene.node_count(block); ++i) leaves[scene.first_node(block) + i] = 1;
  return leaves;
}

/// A box slides over a fixed bed, and one on top of it with it.
struct Pile {
  Scene scene;
  Index bed, low, high;
  explicit Pile(Real local_damping = 0) {
    bed = scene.add_box({-2, -2, -1}, {4, 4, 1}, true);
    low = scene.add_box({-0.5, -0.5, 0}, {1, 1, 1});
    high = scene.add_box({-0.4, -0.4, 1}, {0.8, 0.8, 0.8});
    scene.build();
    scene.model.gravity = {0, 0, -10};
    scene.model.check_search = true;
    scene.model.contact_damping = 0.1;
    scene.model.stiffness_damping = 0.1;
    scene.model.damping.local = local_damping;
    scene.set_interface({{"friction_angle", 0.6}});
    for (const Index box : {low, high}) scene.set_motion(box, {1, 0, -0.1});
    scene.start();
    scene.step(60);
  }
  Energies ledger() const { return energies(scene.model, scene.state); }
  Index contacts() const {
    Index count = 0;
    for (std::size_t k = 0; k < scene.state.springs.target.size(); ++k)
      count += on_host(scene.state.springs.target)[k] >= 0;
    return count;
  }
};

}  // namespace

TEST_CASE("what is taken out leaves the ledger by its own term, to the last bit of round-off") {
  for (const Real local_damping : {0.0, 0.3}) {
    CAPTURE(local_damping);
    Pile pile(local_damping);
    REQUIRE(pile.contacts() > 0);
    const Energies before = pile.ledger();
    take_out(pile.scene.model, pile.scene.state, flags_of(pile.scene, pile.low).data());
    const Energies after = pile.ledger();
    const auto fell = [&](const char* name) {
      std::size_t k = 0;
      while (std::string(energy_terms[k].name) != name) ++k;
      return before.terms[k] - after.terms[k];
    };
    CHECK(fell("kinetic") > 0.4 * before.terms[energy_term("kinetic")]);
    CHECK(fell("strain") > 0);
    CHECK(fell("contact") > 0.9 * before.terms[energy_term("contact")]);
    const Real scale = before.terms[energy_term("kinetic")];
    for (const char* kept : {"friction", "damping", "fracture", "external", "step_change"})
      CHECK(std::abs(fell(kept)) < 1e-13 * scale);
    CHECK(std::abs(after.terms[energy_term("taken_out")] - fell("kinetic") - fell("strain") -
                   fell("contact")) < 1e-13 * scale);
    CHECK(std::abs(after.error - before.error) < 1e-13);
  }
}

TEST_CASE("what is taken out stays where it is and nothing touches it") {
  Pile pile;
  Scene& scene = pile.scene;
  const Index first = scene.first_node(pile.low), top = scene.first_node(pile.high);
  take_out(scene.model, scene.state, flags_of(scene, pile.low).data());
  const Vec place = scene.position(first), above = scene.position(top);
  const SearchState& search = scene.state.search;
  for (Index f = 0; f < scene.model.face_count; ++f)
    CHECK((on_host(search.face_exposed)[f] < 0) ==
          (on_host(scene.model.face_block)[f] == pile.low));
  CHECK(pile.contacts() == 0);  // all were of the box that left
  // the other one falls through its place onto the bed
  const Real begin = scene.state.time;
  const Real up = scene.velocity(top).z;
  scene.step(40);
  const Real passed = scene.state.time - begin;
  CHECK(norm(scene.position(first) - place) == 0);
  CHECK(norm(scene.velocity(first)) == 0);
  CHECK(std::abs(scene.position(top).z - above.z - up * passed + 5 * passed * passed) < 5e-3);
  scene.step(800);
  CHECK(scene.state.missed == 0);
  CHECK(scene.position(top).z < 0.2);  // it has hit the bed
  CHECK(scene.velocity(top).z > 0);
  CHECK(norm(scene.position(first) - place) == 0);
  CHECK(std::abs(pile.ledger().error) < 5e-3);
  for (Index k = 0; k < 3; ++k) CHECK(on_host(scene.state.nodes.reaction)[4 * first + k] == 0);
}

TEST_CASE("a body that leaves keeps no force in its bonds") {
  Scene scene;
  scene.bonded = true;
  const Index low = scene.add_box({0, 0, 0}, {1, 1, 1});
  const Index high = scene.add_box({0, 0, 1}, {1, 1, 1});
  const Index other = scene.add_box({5, 0, 0}, {1, 1, 1});
  scene.build();
  scene.set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}, {"friction_angle", 0.5}});
  scene.set_motion(low, {0, 0, 0.5});
  scene.set_motion(other, {1, 0, 0});
  scene.start();
  scene.step(20);
  REQUIRE(on_host(scene.state.quads.stored)[0] > 0);
  const Real limit = step_limit(scene.model, scene.state).dt;
  std::vector<Flag> leaves = flags_of(scene, low);
  for (Index i = 0; i < scene.node_count(high); ++i) leaves[scene.first_node(high) + i] = 1;
  take_out(scene.model, scene.state, leaves.data());
  CHECK(PairStatus(on_host(scene.state.quads.status)[0]) == PairStatus::released);
  CHECK(step_limit(scene.model, scene.state).dt > limit);  // bonds do not count any more
  scene.step(50);
  const Energies e = energies(scene.model, scene.state);
  CHECK(e.terms[energy_term("contact")] == 0);
  CHECK(relative_error(e.terms[energy_term("kinetic")], 0.5 * 2500) < 1e-12);
  CHECK(std::abs(e.error) < 1e-3);
}

TEST_CASE("supports and materials of what is out are added once") {
  Pile pile;
  Model& m = pile.scene.model;
  take_out(m, pile.scene.state, flags_of(pile.scene, pile.low).data());
  const std::size_t supports = m.support_component.size(), materials = m.material_mu.size();
  const Index first = pile.scene.first_node(pile.low);
  on_host(m.support)[first] = -1;  // as a stage hands it over
  on_host(m.gravity_mass)[first] = 7;
  hold_taken_out(m, pile.scene.state);
  CHECK(on_host(m.support)[first] >= 0);
  CHECK(on_host(m.gravity_mass)[first] == 0);
  CHECK(m.support_component.size() == supports);
  CHECK(m.material_mu.size() == materials);
}

}  // namespace cdem::test
