// Which nodes have dashpots to the ground.
#include "core/nodes/ground.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/views.hpp"
#include "core/surface/laws.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two tets; a quiet entry acts on a face of the first twice, from when it has begun.
struct Quieted : Scene {
  Quieted() {
    add<Tet4>({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    add<Tet4>({{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}}});
    build();
    SurfaceSet& g = given_of<Surface>(model);
    Surface::take_counts(g, [](const char* name) {
      const std::string of = name;
      return of == "surface.count" ? 1 : of == "surface_triangles.count" ? 2 : 0;
    });
    push(g.law, 1), push(g.curve, 0), push(g.waits, 1), push(g.parameters, 1);
    g.parameters.resize(surface_row);
    g.triangles.nodes.resize(3 * g.triangles.stride);
    g.triangles.entry.resize(g.triangles.stride);
    for (std::size_t f = 0; f < 2; ++f) {
      for (std::size_t k = 0; k < 3; ++k)
        on_host(g.triangles.nodes)[k * g.triangles.stride + f] = k;
      push(g.triangles.area, 0.5);
      for (const Real n : {0.0, 0.0, -1.0}) push(g.triangles.normal, n);
      for (const Real z : {60.0, 30.0}) push(g.triangles.impedance, z);
    }
    Surface::start(model, state);
    list_ground(model, state);
  }
};

}  // namespace

TEST_CASE("nodes sum their dashpots once their entry has begun, and move lumped masses then") {
  Quieted scene;
  CHECK(scene.state.ground.node.size() == 0);
  CHECK(scene.state.nodes.radiated.size() == 0);
  const Flag begins = 1;
  Surface::begin(scene.model, scene.state, &begins);
  list_ground(scene.model, scene.state);
  list_lumped(scene.model, scene.state);
  CHECK(fetch(scene.state.ground.node) == std::vector<Index>{0, 1, 2});
  CHECK(fetch(scene.state.ground.row) == std::vector<Index>{0, 1, 2, -1, -1, -1, -1, -1});
  const std::vector<Real> matrix = fetch(scene.state.ground.matrix);
  for (std::size_t node = 0; node < 3; ++node) {  // two faces, a third of 0.5 m2 each
    CHECK(matrix[8 * node] == doctest::Approx(10).epsilon(1e-14));
    CHECK(matrix[8 * node + 2] == doctest::Approx(20).epsilon(1e-14));
    CHECK(matrix[8 * node + 3] == 0);
  }
  const MassColumns mass = on_host(mass_columns(scene.model, scene.state));
  const NodePorts ports = on_host(node_ports(scene.model, scene.state));
  for (Index i = 0; i < 8; ++i) {
    CHECK(mass.is_lumped(i) == (i < 4));
    CHECK(ports.is_loaded(i) == (i < 3));
  }
}

}  // namespace cdem::test
