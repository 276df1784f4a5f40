// Which nodes are computed.
#include "core/nodes/awake_nodes.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a node wakes if it does not sleep, is on a pair list, or was on the last one") {
  const Flag sleeps[] = {1, 0, 1, 1};
  const Index contact_first[] = {0, 0, 0, 2, 2};
  Flag listed[] = {0, 0, 0, 1}, wakes[4];
  const FindWakingNodes find{.own = nullptr,
                             .sleeps = sleeps,
                             .contact_first = contact_first,
                             .listed = listed,
                             .wakes = wakes};
  for (Index i = 0; i < 4; ++i) find(One{i});
  const Flag expected[] = {0, 1, 1, 1}, listed_now[] = {0, 0, 1, 0};
  for (Index i = 0; i < 4; ++i) CHECK(wakes[i] == expected[i]);
  for (Index i = 0; i < 4; ++i) CHECK(listed[i] == listed_now[i]);
}

TEST_CASE("nodes that a rank does not own sleep on its lists, too") {
  const Flag sleeps[] = {0, 0}, own[] = {1, 0};
  const Index contact_first[] = {0, 1, 2};
  Flag listed[] = {0, 0}, wakes[2];
  const FindWakingNodes find{.own = own,
                             .sleeps = sleeps,
                             .contact_first = contact_first,
                             .listed = listed,
                             .wakes = wakes};
  for (Index i = 0; i < 2; ++i) find(One{i});
  CHECK(wakes[0] == 1);
  CHECK(wakes[1] == 0);
}

TEST_CASE("nodes that share a mass matrix wake together, also in other blocks of eight") {
  constexpr Index count = 18;
  Flag wakes[count] = {};
  Index row[count], first[count], size[count];
  for (Index i = 0; i < count; ++i) row[i] = first[i] = 0, size[i] = 12;
  for (Index i = 12; i < count; ++i) row[i] = -1, first[i] = 12, size[i] = 6;
  wakes[11] = 1;
  BlockIsAwake is_awake{.count = count,
                        .wakes = wakes,
                        .lumped = false,
                        .mass_row_first = row,
                        .block_first = first,
                        .block_count = size};
  CHECK(is_awake(One{0}));
  CHECK(is_awake(One{1}));
  CHECK(!is_awake(One{2}));  // of another block
  is_awake.lumped = true;
  CHECK(!is_awake(One{0}));
  wakes[11] = 0, wakes[15] = 1;
  CHECK(is_awake(One{1}));
  CHECK(!is_awake(One{2}));  // without a matrix nodes wake alone
}

}  // namespace cdem::test
