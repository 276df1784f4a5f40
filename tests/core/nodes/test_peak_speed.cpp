// Largest speeds of nodes.
#include "core/nodes/peak_speed.hpp"
#include "tests/core/nodes/points.hpp"

namespace cdem::test {

TEST_CASE("a peak grows with the speed and stays when that falls") {
  Points points(2);
  std::vector<Real> peak{0, 50};
  const KeepPeak keep{{points.motion.data()}, peak.data()};
  points.move(0, {3, -4, 12});
  points.move(1, {3, -4, 0});
  keep(One{0}), keep(One{1});
  CHECK(peak == std::vector<Real>{169, 50});
  points.move(0, {1, 1, 1});
  points.move(1, {0, 0, -8});
  keep(One{0}), keep(One{1});
  CHECK(peak == std::vector<Real>{169, 64});
}

}  // namespace cdem::test
