// Loads on nodes: gravity, and forces that follow curves.
#include "core/nodes/loads.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a node feels its weight and its loads, each scaled by its curve") {
  const Real mass[] = {2, 3}, force[] = {1, 0, 0, 0, 0, 10, 0, 0}, factor[] = {0.5, 3};
  const Real relief[] = {0, 0, 0, 0, 4, 0, 8, 0};
  const Index first[] = {0, 0, 2}, curve[] = {0, 1};
  LoadColumns loads{.gravity = {0, 0, -10},
                    .gravity_mass = mass,
                    .load_first = first,
                    .load_curve = curve,
                    .load_force = force,
                    .curve_value = factor,
                    .relief = nullptr,
                    .relief_part = 0.25,
                    .water = nullptr};
  CHECK(distance(loads.at(0).vector(), Vec{0, 0, -20}) == 0);
  CHECK(distance(loads.at(1).vector(), Vec{0.5, 30, -30}) == 0);
  loads.relief = relief;
  CHECK(distance(loads.at(0).vector(), Vec{0, 0, -20}) == 0);
  CHECK(distance(loads.at(1).vector(), Vec{1.5, 30, -28}) == 0);
}

}  // namespace cdem::test
