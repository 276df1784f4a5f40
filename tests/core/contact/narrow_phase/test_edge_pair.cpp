// Pairs of sides: codes, and which ways are open.
#include "core/contact/narrow_phase/edge_pair.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("shared ends follow when a side is run through backwards") {
  const auto bit = [](Index a, Index b) { return 1 << (2 * a + b); };
  for (Index a = 0; a < 2; ++a)
    for (Index b = 0; b < 2; ++b) {
      CHECK(EdgeWays::turned(bit(a, b), false, false) == bit(a, b));
      CHECK(EdgeWays::turned(bit(a, b), true, false) == bit(1 - a, b));
      CHECK(EdgeWays::turned(bit(a, b), false, true) == bit(a, 1 - b));
      CHECK(EdgeWays::turned(bit(a, b), true, true) == bit(1 - a, 1 - b));
    }
}

TEST_CASE("the code of a pair of edges holds ways, shared ends and directions apart") {
  for (Index turned = 0; turned < 4; ++turned) {
    const Index code = EdgeWays::code_of(0xa5, 0x9, 0x6, turned);
    CHECK((code & 0xff) == 0xa5);
    CHECK((code >> EdgeWays::count & 15) == 0x9);
    CHECK((code >> (EdgeWays::count + 4) & 15) == 0x6);
    CHECK(EdgeWays::is_turned(code, 0) == (turned & 1));
    CHECK(EdgeWays::is_turned(code, 1) == (turned >> 1 & 1));
    for (Index a = 0; a < 2; ++a)
      for (Index b = 0; b < 2; ++b) CHECK(EdgeWays::share(code, a, b) == (0x9 >> (2 * a + b) & 1));
    for (Index side = 0; side < 4; ++side)
      CHECK(EdgeWays::runs_against(code, side / 2, side % 2) == (0x6 >> side & 1));
    CHECK(!EdgeWays::are_neighbours(code, 0));
    CHECK(!EdgeWays::have_others(code));
    CHECK(EdgeWays::are_neighbours(EdgeWays::with_neighbours(code, 1), 1));
    CHECK(!EdgeWays::are_neighbours(EdgeWays::with_neighbours(code, 1), 0));
    CHECK(EdgeWays::have_others(EdgeWays::with_others(code)));
    CHECK((EdgeWays::with_others(EdgeWays::with_neighbours(code, 0)) & 0x3ffff) == code);
  }
  for (Index way = 0; way < EdgeWays::count; ++way) {
    CHECK(EdgeWays::mother(way) / 2 == EdgeWays::is_reverse(way));
    CHECK(EdgeWays::target(way) / 2 == !EdgeWays::is_reverse(way));
    const Index first = EdgeWays::is_reverse(way) ? EdgeWays::target(way) : EdgeWays::mother(way);
    CHECK(first % 2 == (way >> 1 & 1));
  }
  CHECK(EdgeWays::is_reverse(EdgeWays::way(true, 0, 1)));
  CHECK(!EdgeWays::is_reverse(EdgeWays::way(false, 1, 1)));
}

TEST_CASE("sides cross beyond their ends where the crossing is outside of 0 to 1") {
  const SearchRules rules;
  const auto beyond = [&](Real s, Real t, Real slack) {
    // along x and along y, crossing at s and t; the indented side is as long as 1 - alpha
    const Vec dm{1, 0, 0}, dt{0, 1, 0}, c = cross(dm, dt);
    return crosses_beyond(Vec{-s, 0, 0}, dm, Vec{0, -t, 0}, dt, c, dot(c, c), rules, slack);
  };
  CHECK(!beyond(0.5, 0.5, 0.0));
  CHECK(!beyond(0.0, 0.0, 0.0));
  CHECK(!beyond(1 - rules.indentation, 1.0, 0.0));
  CHECK(beyond(-0.01, 0.5, 0.0));
  CHECK(beyond(1 - rules.indentation + 0.001, 0.5, 0.0));
  CHECK(beyond(0.5, -0.01, 0.0));
  CHECK(beyond(0.5, 1.01, 0.0));
  CHECK(!beyond(-0.01, 1.01, 0.02));
}

}  // namespace cdem::test
