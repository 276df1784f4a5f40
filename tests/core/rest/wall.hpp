// wall.hpp - bonded boxes on a base that is fixed.
#pragma once

#include "tests/core/scene.hpp"

namespace cdem::test {

struct Wall : Scene {
  static constexpr Index across = 3, rows = 8;

  explicit Wall(bool with_bonds = true) {
    bonded = with_bonds;
    for (Index z = 0; z < rows; ++z)
      for (Index x = 0; x < across; ++x) add_box({Real(x), 0, Real(z)}, {1, 1, 1}, z == 0);
    build();
    model.gravity = {0, 0, -9.81};
    set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}, {"friction_angle", 0.5}});
    start();
  }
};

}  // namespace cdem::test
