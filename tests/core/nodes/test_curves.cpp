// Factors of the load and velocity curves.
#include "core/nodes/curves.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("curves are linear between their points, constant outside, and may jump") {
  Model m;
  m.curve_time = {{1, 2, 4}, {0}, {0, 1, 1, 2}};
  m.curve_factor = {{10, 20, 0}, {7}, {0, 1, 5, 5}};
  State s;
  const auto check = [&](Real time, Real first, Real third) {
    s.time = time;
    set_loads_and_supports(m, s);
    CHECK(std::abs(on_host(s.load_factor)[0] - first) < 1e-14);
    CHECK(on_host(s.load_factor)[1] == 7);
    CHECK(std::abs(on_host(s.load_factor)[2] - third) < 1e-14);
  };
  check(0, 10, 0);
  check(1, 10, 5);
  check(1.5, 15, 5);
  check(3, 10, 5);
  check(4, 0, 5);
  check(9, 0, 5);
  check(0.5, 10, 0.5);
}

TEST_CASE("velocities follow their curves at the middle of the coming step, loads at its start") {
  Model m;
  m.curve_time = {{0, 1}};
  m.curve_factor = {{0, 1}};
  State s;
  s.time = 0.25;
  s.dt = 0.5;
  set_loads_and_supports(m, s);
  CHECK(on_host(s.load_factor)[0] == 0.25);
  CHECK(on_host(s.velocity_factor)[0] == 0.5);
}

}  // namespace cdem::test
