// A spring whose force has limits.
#include <cmath>

#include "core/bolts/slider.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a slider is elastic between its limits and stays at them beyond") {
  const Slider s{.stiffness = 2e6, .free = 1e-3, .least = -500, .most = 800};
  CHECK(s.state(1e-3) == SliderState::holds);
  CHECK(s.state(1.5e-3) == SliderState::upper);
  CHECK(s.state(0.5e-3) == SliderState::lower);
  CHECK(relative_error(s.force(1.2e-3, SliderState::holds), 400) < 1e-12);
  CHECK(relative_error(s.force(1.5e-3, SliderState::upper), 800) < 1e-6);
  CHECK(relative_error(s.force(0.5e-3, SliderState::lower), -500) < 2e-6);
  CHECK(s.tangent(SliderState::holds) == 2e6);
  CHECK(s.tangent(SliderState::upper) == slider_rest * 2e6);
}

TEST_CASE("what it bears follows from where it is free then") {
  const Slider s{.stiffness = 2e6, .free = 0, .least = -500, .most = 800};
  const Real force = s.force(1e-3, s.state(1e-3));
  const Slider later{s.stiffness, s.free_after(1e-3, force), s.least, s.most};
  CHECK(relative_error(later.trial(1e-3), force) < 1e-12);
  CHECK(relative_error(s.stored(force), 0.5 * force * force / 2e6) < 1e-12);
}

TEST_CASE("a cable that has yielded is slack until it is as long again") {
  Slider cable{.stiffness = 1e6, .free = 0, .least = 0, .most = 1000};
  const auto bears = [&](Real x) {
    const Real force = cable.force(x, cable.state(x));
    cable.free = cable.free_after(x, force);
    return force;
  };
  CHECK(relative_error(bears(3e-3), 1000) < 3e-6);  // yields by 2 mm
  CHECK(relative_error(bears(2.5e-3), 500) < 1e-5);
  CHECK(std::abs(bears(-1e-3)) < 0.01);  // slack
  CHECK(std::abs(bears(1.5e-3)) < 0.01);
  CHECK(relative_error(bears(2.5e-3), 500) < 1e-5);
  CHECK(relative_error(cable.free, 2e-3) < 1e-5);
}

TEST_CASE("without stiffness it bears and stores nothing") {
  const Slider none{};
  CHECK(none.force(0.1, none.state(0.1)) == 0);
  CHECK(none.free_after(0.1, 0) == 0);
  CHECK(none.stored(0) == 0);
}

}  // namespace cdem::test
