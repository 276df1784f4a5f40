// The rows of forces that each node sums.
#include "core/nodes/corner_rows.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("rows of elements come first, then those of bonds with their sign") {
  const Real rows[] = {1, 2, 3, 0, 10, 20, 30, 0, 100, 200, 300, 0};
  const Index first[] = {0, 3, 3, 4}, corner[] = {1, ~0, 2, ~2};
  const CornerLists lists{first, corner, {rows}, nullptr, nullptr, {nullptr}};
  CHECK(distance(lists.sum(0, Row::zero()).vector(), Vec{109, 218, 327}) == 0);
  CHECK(distance(lists.sum(1, Row::of(4, 5, 6)).vector(), Vec{4, 5, 6}) == 0);
  CHECK(distance(lists.sum(2, Row::zero()).vector(), Vec{-100, -200, -300}) == 0);
}

}  // namespace cdem::test
