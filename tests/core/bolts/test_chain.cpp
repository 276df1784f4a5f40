// Axial equilibrium of a bolt.
#include "core/bolts/chain.hpp"
#include "tests/core/bolts/chain_columns.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

constexpr Real grout_stiffness = 112e6, grout_strength = 0.175e6;  // [N/m2] [N/m]

Real largest_residual(ChainColumns& bolt) {
  Real largest = 0;
  for (Index i = 0; i < bolt.count; ++i) largest = std::max(largest, std::abs(bolt.residual(i)));
  return largest;
}

}  // namespace

TEST_CASE("a joint that opens pulls the bolt out of both sides: E A lambda / 2 times its opening") {
  const Real part = 0.02, lambda = std::sqrt(grout_stiffness / 18e6);
  ChainColumns bolt(300, part, grout_stiffness, grout_strength);
  bolt.stretch(149, 1e-4);
  bolt.chain().solve();
  CHECK(largest_residual(bolt) < 1e-8);
  // two bolts of 3 m in series, as stiff as they were without end
  CHECK(relative_error(bolt.bar_force(149), 18e6 * lambda / 2 * 1e-4) < 1e-3);
  CHECK(bolt.slip[149] > 0);  // the head's side slips towards the toe
  CHECK(std::abs(bolt.slip[149] + bolt.slip[150]) < 1e-12);
}

TEST_CASE("grout slips where it must, and a bolt never bears more than its grout") {
  Random random(3);
  ChainColumns bolt(80, 0.05, grout_stiffness, grout_strength);
  for (int step = 0; step < 50; ++step) {
    for (Index j = 0; j + 1 < bolt.count; ++j)
      bolt.stretch(j, (step + 1) * 1e-4 * random.between(-1, 1));
    bolt.chain().solve();
    CHECK(largest_residual(bolt) < 1e-4);  // of 8.75 kN that a node bears
    for (Index i = 0; i < bolt.count; ++i) {
      const Slider g = bolt.chain().grout(i);
      const Real force = g.force(bolt.slip[i], SliderState(bolt.grout_state[i]));
      CHECK(std::abs(force) < grout_strength * 0.05 * (1 + 1e-4));
      bolt.grout_free[i] = g.free_after(bolt.slip[i], force);
    }
  }
}

TEST_CASE("a bolt of which all grout slips still has one solution") {
  ChainColumns bolt(40, 0.05, grout_stiffness, grout_strength);
  bolt.end[0] = 1e9, bolt.end[1] = 1e12;  // the plate holds: 0.35 MN is all that the grout can bear
  bolt.stretch(0, 0.2);
  bolt.chain().solve();
  CHECK(largest_residual(bolt) < 1e-2);
  CHECK(relative_error(bolt.bar_force(0), 39 * 0.05 * grout_strength) < 1e-3);
}

TEST_CASE("steel yields at its limits, tears at its strain, and bears nothing then") {
  ChainColumns bolt(2, 1, 0, 0);
  bolt.steel.yield = 1e5, bolt.steel.crush = 0, bolt.steel.rupture_strain = 0.1;
  bolt.end = {1e9, 1e12, 1e9, 1e12};
  bolt.stretch(0, 0.05);
  bolt.chain().solve();
  CHECK(!bolt.chain().tear());
  CHECK(relative_error(bolt.bar_force(0), 1e5) < 2e-5);
  bolt.stretch(0, -0.05);
  bolt.chain().solve();
  CHECK(std::abs(bolt.bar_force(0)) < 10);  // a cable cannot be pushed
  bolt.stretch(0, 0.11);
  bolt.chain().solve();
  CHECK(bolt.chain().tear());
  CHECK(bolt.bar_broken[0] == Flag(BarState::ruptured));
  bolt.chain().solve();
  CHECK(!bolt.chain().tear());
  bolt.bar_free[0] = bolt.chain().extension(0);
  CHECK(bolt.bar_force(0) == 0);
}

TEST_CASE("a plate presses and lifts off; a jack pulls at the head") {
  ChainColumns bolt(20, 0.1, grout_stiffness, grout_strength);
  bolt.end[0] = 1e9, bolt.end[1] = 1e12;
  bolt.steel.pretension = 5e4;
  bolt.jacked = true;
  bolt.chain().solve();
  CHECK(relative_error(bolt.bar_force(0) - bolt.chain().grout(0).trial(bolt.slip[0]), 5e4) < 1e-4);
  ChainColumns pushed(20, 0.1, grout_stiffness, grout_strength);
  pushed.end[0] = 1e9, pushed.end[1] = 1e12;
  pushed.stretch(0, -1e-4);  // the head is pushed out
  pushed.chain().solve();
  CHECK(pushed.slip[0] < 0);
  CHECK(std::abs(pushed.chain().end(0).force(pushed.slip[0], SliderState(pushed.end_state[0]))) <
        1);
}

TEST_CASE("a part that hangs on nothing stays where it is") {
  ChainColumns bolt(4, 1, 0, 0);
  bolt.stretch(1, 0.01);
  bolt.chain().solve();
  for (Index i = 0; i < 4; ++i) CHECK(std::isfinite(bolt.slip[i]));
  for (Index j = 0; j < 3; ++j) CHECK(std::abs(bolt.bar_force(j)) < 1e-6);
}

}  // namespace cdem::test
