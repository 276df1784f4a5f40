// Forces of contacts on the vertices of their faces, and what semi-edges lose.
#include "core/contact/force/accumulate.hpp"
#include "core/diagnostics/energy.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two ridges (wedges) that cross, the upper one upside down; it falls and slides along both.
struct Ridges : Scene {
  Ridges() {
    add<Wedge6>({{{1, -2, -1}, {-1, -2, -1}, {0, -2, 0}, {1, 2, -1}, {-1, 2, -1}, {0, 2, 0}}});
    const Real s = std::sin(1.2), c = std::cos(1.2), gap = 1e-4;
    const auto turned = [&](Real x, Real y, Real z) {
      return Vec{c * x - s * y + 0.1, s * x + c * y - 0.3, z};
    };
    const Index upper =
        add<Wedge6>({{turned(-1, -2, 1 + gap), turned(1, -2, 1 + gap), turned(0, -2, gap),
                      turned(-1, 2, 1 + gap), turned(1, 2, 1 + gap), turned(0, 2, gap)}});
    build();
    model.step_given = 1e-4;
    set_interface({{"friction_angle", 0.5}});
    set_motion(upper, {0.6, 0.3, -1});
    start();
  }
  Index edge_count() const { return Index(state.edges.contact.size() / 4); }
  Real shear_energy() const {
    Real sum = 0;
    for (Index c = 0; c < edge_count(); ++c)
      sum += ContactState::at(state.edges.state.data(), c).energy_s;
    return sum;
  }
};

}  // namespace

TEST_CASE("forces of crossing edges and their moments sum to zero") {
  Ridges ridges;
  ridges.step(50);
  CHECK(ridges.edge_count() == 4);
  Vec force{0, 0, 0}, moment{0, 0, 0};
  Real size = 0;
  for (std::size_t x = 0; x < ridges.state.search.exposed_face.size(); ++x)
    for (Index k = 0; k < 4; ++k) {
      const Index node = ridges.model.face_nodes[4 * ridges.state.search.exposed_face[x] + k];
      if (node < 0) continue;
      // where the node was when the force was found
      const Vec at = ridges.position(node) - ridges.state.dt_last * ridges.velocity(node);
      const Vec f = vector_at(ridges.state.contact_force.data() + (4 * x + k) * 4);
      force = force + f;
      moment = moment + cross(at, f);
      size += norm(f);
    }
  CHECK(size > 0);
  CHECK(norm(force) < 1e-15 * size);
  CHECK(norm(moment) < 1e-14 * size);
}

TEST_CASE("energies close in every step while edges alone press and slide") {
  Ridges ridges;
  Real shear = 0, worst = 0;
  for (int n = 0; n < 1000; ++n) {
    ridges.step(1);
    worst = std::max(worst, std::abs(energies(ridges.model, ridges.state).error));
    shear = std::max(shear, ridges.shear_energy());
  }
  const Energies e = energies(ridges.model, ridges.state);
  CHECK(ridges.edge_count() == 0);
  CHECK(shear > 0.03 * e.start);
  CHECK(e.terms[energy_term("friction")] > 0.05 * e.start);
  CHECK(worst < 1e-4);  // falls with the square of the time step
}

}  // namespace cdem::test
