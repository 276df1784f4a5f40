// The rows of forces that each node sums.
#include "core/nodes/corner_rows.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("rows of tiles come first, then those of bonds with their sign") {
  const Real tiles[] = {1e20, 0, 0, 0, 5, 6, 7, 0}, rows[] = {1, 2, 3, 0, 1e20, 20, 30, 0};
  const Index tile_first[] = {0, 1, 1, 2};
  const Index first[] = {0, 2, 2, 3}, corner[] = {~1, 0, ~0};
  const CornerLists lists{tile_first, {tiles}, first, corner, {rows}, nullptr, nullptr, {nullptr}};
  CHECK(distance(lists.sum(0, Row::zero()).vector(), Vec{1, -18, -27}) == 0);
  CHECK(distance(lists.sum(1, Row::of(4, 5, 6)).vector(), Vec{4, 5, 6}) == 0);
  CHECK(distance(lists.sum(2, Row::zero()).vector(), Vec{4, 4, 4}) == 0);
}

}  // namespace cdem::test
