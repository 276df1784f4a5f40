// Lists of what the broad phase finds.
#include "core/contact/broad_phase/pair_buffer.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a list that grows by parts keeps its items where they are") {
  PartedList<Index> list;
  CHECK(list.size() == 0);
  list.push_back(7);
  const Index* first = &list[0];
  constexpr Index count = 100000;  // five parts
  for (Index i = 1; i < count; ++i) list.push_back(3 * i);
  REQUIRE(list.size() == count);
  CHECK(&list[0] == first);
  CHECK(list[0] == 7);
  for (Index i = 1; i < count; ++i) REQUIRE(list[i] == 3 * i);
  list = {};
  CHECK(list.size() == 0);
}

}  // namespace cdem::test
