// All ways in which a force comes to a node.
#include "core/nodes/ports.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Three nodes: the first has its weight alone, the second loads, the third rows of each kind.
struct Ports {
  const Real mass[3] = {2, 3, 0}, force[8] = {1, 0, 0, 0, 0, 10, 0, 0}, factor[2] = {0.5, 3};
  Real relief[12] = {0, 0, 0, 0, 4, 0, 8, 0}, applied[12] = {0, 0, 0, 0, 0, 0, 7, 0};
  const Index load_first[4] = {0, 0, 2, 2}, load_curve[2] = {0, 1};
  const Real tiles[4] = {1e20, 0, 0, 0}, rows[8] = {1, 2, 3, 0, 1e20, 20, 30, 0};
  const Real contacts[4] = {5, 6, 7, 8};
  const Index tile_first[4] = {0, 0, 0, 1}, first[4] = {0, 0, 0, 2}, corner[2] = {~1, 0};
  const Index contact_first[4] = {0, 0, 0, 1}, contact_corner[1] = {0};
  const Flag has_applied[3] = {0, 1, 0};
  NodePorts ports{
      .loads = {.gravity = {0, 0, -10},
                .gravity_mass = mass,
                .load_first = load_first,
                .load_curve = load_curve,
                .load_force = force,
                .curve_value = factor,
                .relief = nullptr,
                .relief_part = 0.25,
                .applied = nullptr},
      .has_applied = nullptr,
      .ground = nullptr,
      .corners = {
          tile_first, {tiles}, first, corner, {rows}, contact_first, contact_corner, {contacts}}};
};

}  // namespace

TEST_CASE("a node feels its weight and its loads, each scaled by its curve") {
  Ports p;
  LoadColumns& loads = p.ports.loads;
  CHECK(distance(loads.at(0).vector(), Vec{0, 0, -20}) == 0);
  CHECK(distance(loads.at(1).vector(), Vec{0.5, 30, -30}) == 0);
  loads.relief = p.relief;
  CHECK(distance(loads.at(0).vector(), Vec{0, 0, -20}) == 0);
  CHECK(distance(loads.at(1).vector(), Vec{1.5, 30, -28}) == 0);
  loads.applied = p.applied;
  CHECK(distance(loads.at(1).vector(), Vec{1.5, 30, -21}) == 0);
}

TEST_CASE("rows of tiles come first, then those of bonds with their sign, then contacts") {
  const Row sum = Ports().ports.sum(2);
  CHECK(distance(sum.vector(), Vec{6, -12, -20}) == 0);  // 1e20 - 1e20 + 1 + 5: exact in this order
  CHECK(sum.n[3] == 8);
}

TEST_CASE("each port answers whether it leaves a node plain, and whether it loads it") {
  // A new port does not compile here: it needs its line in sum, in is_plain and in is_loaded.
  const Ports quiet;
  [[maybe_unused]] const auto& [loads, has_applied, ground, corners] = quiet.ports;
  CHECK((quiet.ports.is_plain(0) && !quiet.ports.is_loaded(0)));
  CHECK((!quiet.ports.is_plain(1) && quiet.ports.is_loaded(1)));   // curves
  CHECK((!quiet.ports.is_plain(2) && !quiet.ports.is_loaded(2)));  // contacts
  Ports p;
  const Index no_loads[4] = {};
  p.ports.loads.load_first = no_loads;
  CHECK((p.ports.is_plain(1) && !p.ports.is_loaded(1)));
  p.ports.has_applied = p.has_applied;  // though its row is still zero
  CHECK((!p.ports.is_plain(1) && p.ports.is_loaded(1)));
  CHECK((p.ports.is_plain(0) && !p.ports.is_loaded(0)));
  p.ports.has_applied = nullptr;
  const Index dashed[3] = {-1, 0, -1};
  p.ports.ground = dashed;
  CHECK((!p.ports.is_plain(1) && p.ports.is_loaded(1)));
  CHECK((p.ports.is_plain(0) && !p.ports.is_loaded(0)));
  p.ports.ground = nullptr;
  p.ports.loads.relief = p.relief;
  CHECK((!p.ports.is_plain(1) && p.ports.is_loaded(1)));
  CHECK((p.ports.is_plain(0) && !p.ports.is_loaded(0)));
  for (Index axis = 0; axis < 3; ++axis) {
    std::fill_n(p.relief, 12, 0.0);
    p.relief[axis] = -1e-300;
    CHECK(p.ports.is_loaded(0));
  }
}

}  // namespace cdem::test
