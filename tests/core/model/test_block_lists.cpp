// Which blocks of consecutive items a step runs.
#include "core/model/block_lists.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("blocks with an item that is awake are listed") {
  Column<Index> list;
  list_blocks(3 * block_size + 2, list,
              [&](Index i) { return i == 1 || i == block_size - 1 || i == 3 * block_size + 1; });
  REQUIRE(list.size() == 2);
  CHECK(on_host(list)[0] == 0);
  CHECK(on_host(list)[1] == 3);
}

TEST_CASE("an empty list stands for no block, a plan that wakes everything for all") {
  Column<Index> list;
  CHECK(awake({}, list).id != nullptr);
  CHECK(awake({}, list).count == 0);
  CHECK(awake({.everything_awake = true}, list).id == nullptr);
  list.assign({4});
  CHECK(awake({}, list).count == 1);
  CHECK(awake({}, list).id[0] == 4);
}

TEST_CASE("blocks are fused where the plan says so and some are found") {
  State s;
  CHECK(!fuses_blocks(s, {.fuse_blocks = true}));
  s.nodes.fused.resize(3);
  CHECK(fuses_blocks(s, {.fuse_blocks = true}));
  CHECK(!fuses_blocks(s, {}));
}

}  // namespace cdem::test
