// Where a number is among ascending ones, against a look at all of them.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base/sorted.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE_TEMPLATE("a number is found among ascending ones, wherever it is, and no other", T, Index,
                   std::uint64_t) {
  for (Index count = 0; count < 20; ++count) {
    std::vector<T> numbers;
    for (Index i = 0; i < count; ++i) numbers.push_back(T(2 * (i / 3) + 1) << (8 * sizeof(T) - 8));
    for (Index i = 0; i < 17; ++i) {
      const T number = T(i) << (8 * sizeof(T) - 8);
      Index below = 0;
      for (const T other : numbers) below += other < number;
      CHECK(first_from(numbers.data(), count, number) == below);
      CHECK(is_among(numbers.data(), count, number) ==
            (std::count(numbers.begin(), numbers.end(), number) > 0));
    }
  }
}

}  // namespace cdem::test
