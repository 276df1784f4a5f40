// Boxes near others: as a search over all pairs finds them.
#include "core/contact/broad_phase/near_boxes.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

bool are_near(const Box& one, const Box& other, Real within) {
  for (int d = 0; d < 3; ++d)
    if (one.low[d] - other.high[d] > within || other.low[d] - one.high[d] > within) return false;
  return true;
}

}  // namespace

TEST_CASE("boxes are near by the smaller reach of the two") {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Box> boxes(200);
    std::vector<Real> reach(boxes.size());
    std::vector<Flag> flags(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      boxes[i] = Box::nothing();
      const Vec at = random.vector(3);
      boxes[i].include(at);
      boxes[i].include(at + random.vector(i % 50 == 0 ? 8 : 0.3));
      reach[i] = i % 50 == 0 ? 3 : random.between(0, 0.4);
      flags[i] = random.below(20) == 0;
    }
    std::vector<Flag> expected = flags;
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for (std::size_t j = 0; j < boxes.size(); ++j)
        if (flags[j] && are_near(boxes[i], boxes[j], 2 * std::min(reach[i], reach[j])))
          expected[i] = 1;
    Column<Box> all;
    Column<Real> room;
    Column<Flag> near;
    all.assign(boxes);
    room.assign(reach);
    near.assign(flags);
    flag_near(all, room, near);
    CHECK(fetch(near) == expected);
    CHECK(std::count(expected.begin(), expected.end(), 1) >
          std::count(flags.begin(), flags.end(), 1));
  }
}

}  // namespace cdem::test
