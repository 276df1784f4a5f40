// Bonds and joints that begin under stress.
#include "core/bonds/bonds.hpp"
#include "core/bonds/initial_tractions.hpp"
#include "core/diagnostics/energy.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box on a fixed one, under a stress of the joint between them.
struct Stressed : Scene {
  Index box;

  explicit Stressed(const Named& law, Real indentation = 1 - 1 / std::sqrt(3.0)) {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1}, true);
    box = add_box({0, 0, 1}, {1, 1, 1});
    build();
    set_interface(law);
    model.initial_stress = model.loose_pairs = true;
    model.bond_indentation_quad = indentation;
    state.quads.rest.resize(3 * std::size_t(model.quads.points) * model.quads.point_stride);
  }
  /// Stress of all bond points, constant; returns what was cut.
  CutTractions load(const std::array<Real, 6>& stress, bool strong) {
    std::vector<Real> all;
    for (std::size_t k = 0; k < bond_places(model, state).size(); ++k)
      all.insert(all.end(), stress.begin(), stress.end());
    const Flag bonds = strong;
    return set_initial_tractions(model, state, all.data(), &bonds);
  }
  /// Force of the joint on the upper box.
  Vec force() {
    start();
    update_bond_forces(model, state, {}, {.sample = true, .everything_awake = true});
    Vec sum{0, 0, 0};
    for (Index k = 0; k < 4; ++k)
      sum = sum + vector_at(state.corner_force.data() +
                            4 * (std::size_t(model.quads.corner_first) + std::size_t(k)));
    return on_second() ? sum : Real(-1) * sum;
  }
  bool on_second() const {
    return on_host(model.quads.nodes)[4 * model.quads.stride] >= first_node(box);
  }
};

const Named strong{{"cohesion", 1e6}, {"tensile_strength", 1e6}, {"friction_angle", 0.5}};
const Named loose{{"friction_angle", 0.5}};

}  // namespace

TEST_CASE("a joint begins with the traction of its stress, and nothing moves") {
  Stressed s(strong);
  CHECK(s.load({0, 0, -4e4, 0, 2e3, -3e3}, true).count == 0);
  const Vec f = s.force();  // on the upper box, whose outward normal is -z
  CHECK(f.x == doctest::Approx(3e3));
  CHECK(f.y == doctest::Approx(-2e3));
  CHECK(f.z == doctest::Approx(4e4));
  for (Index k = 0; k < 4; ++k)
    CHECK(on_host(s.state.quads.bond)[k * s.model.quads.point_stride] == 1);
}

TEST_CASE("a joint without strength begins broken, and bears what friction bears") {
  Stressed s(loose);
  const CutTractions cut = s.load({0, 0, -4e4, 0, 0, 3e4}, false);
  CHECK(cut.count == 4);
  CHECK(cut.most == doctest::Approx(1e4));  // 3e4 less 0.5 of 4e4
  CHECK(norm(s.force() - Vec{-2e4, 0, 4e4}) < 1e-6);
  for (Index k = 0; k < 4; ++k)
    CHECK(on_host(s.state.quads.bond)[k * s.model.quads.point_stride] == 0);
  s.step(1);
  CHECK(energies(s.model, s.state).terms[energy_term("friction")] < 1e-9);
}

TEST_CASE("a joint without strength does not pull") {
  Stressed s(loose);
  CHECK(s.load({0, 0, 1e4, 0, 0, 0}, false).count == 4);
  CHECK(norm(s.force()) == 0);
}

TEST_CASE("forces on the vertices are those of a linear traction, wherever the bond points are") {
  for (const Real indentation : {0.0, 0.2, 1 - 1 / std::sqrt(3.0)}) {
    Stressed s(strong, indentation);
    std::vector<Real> all;
    for (const BondPlace& place : bond_places(s.model, s.state))
      all.insert(all.end(), {0, 0, -1e3 - 5e2 * place.position.x, 0, 0, 0});
    const Flag bonds = 1;
    set_initial_tractions(s.model, s.state, all.data(), &bonds);
    s.force();
    for (Index k = 0; k < 4; ++k) {
      const Index node = on_host(s.model.quads.nodes)[std::size_t(4 + k) * s.model.quads.stride];
      const Vec f = vector_at(s.state.corner_force.data() +
                              4 * (std::size_t(s.model.quads.corner_first) + std::size_t(k)));
      // 1/4 of the mean traction, and of a linear part x: 1/12 at x = 0, 1/6 at x = 1
      const Real exact = 250 + 500 * (s.position(node).x > 0.5 ? 1.0 / 6 : 1.0 / 12);
      CHECK(std::abs(f.z) == doctest::Approx(exact));
    }
  }
}

TEST_CASE("the search keeps contacts that are lifted as far as the traction needs") {
  Stressed s(loose);
  s.load({0, 0, -4e4, 0, 0, 0}, false);
  CHECK(s.model.rules.lifted == s.model.initial_lift);
  CHECK(s.model.initial_lift > 0);
}

}  // namespace cdem::test
