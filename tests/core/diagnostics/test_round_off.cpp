// What the round-off of positions makes where nothing happens.
#include <limits>

#include "core/diagnostics/round_off.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("round-off grows with the farthest coordinate") {
  for (const Real far : {1.0, 1e6}) {
    Scene scene;
    scene.add_box({0, -far, 0}, {0.5, 0.5, 0.5});
    scene.build();
    const RoundOff nothing(scene.model, scene.state);
    CHECK(nothing.shift == std::numeric_limits<Real>::epsilon() * far);
    Real stiffness = 0;
    for (Index i = 0; i < 8; ++i)
      stiffness += on_host(scene.model.mass)[i] * on_host(scene.model.lumped_frequency_squared)[i];
    CHECK(relative_error(nothing.force, nothing.shift * stiffness) < 1e-14);
  }
}

}  // namespace cdem::test
