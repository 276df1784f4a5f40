// Counts and flags that several threads raise.
#include <vector>

#include "core/base/openmp.hpp"
#include "core/base/parallel.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("raise hands out every number once, on one thread and on several") {
  constexpr Index count = 4000;
  const int threads = omp_get_max_threads();
  for (const bool alone : {true, false}) {
    omp_set_num_threads(alone ? 1 : 3);
    Index next = 0;
    std::vector<Index> taken(count);
#pragma omp parallel for schedule(static)
    for (Index i = 0; i < count; ++i) taken[i] = raise(next, alone);
    CHECK(next == count);
    std::sort(taken.begin(), taken.end());
    for (Index i = 0; i < count; ++i) CHECK(taken[i] == i);
  }
  omp_set_num_threads(threads);
}

TEST_CASE("the largest and the smallest number are kept, on one thread and on several") {
  constexpr Index count = 4000;
  const int threads = omp_get_max_threads();
  for (const bool alone : {true, false}) {
    omp_set_num_threads(alone ? 1 : 3);
    Real most = 0, least = infinity;
#pragma omp parallel for schedule(static)
    for (Index i = 0; i < count; ++i) {
      const Real number = 0.5 + (i * 7 + 13) % count;
      raise_to(most, number, alone);
      lower_to(least, number, alone);
    }
    CHECK(most == count - 0.5);
    CHECK(least == 0.5);
  }
  omp_set_num_threads(threads);
}

TEST_CASE("the lowest index is kept, and every one that was is given back once, on any threads") {
  constexpr Index count = 4000;
  const int threads = omp_get_max_threads();
  for (const bool alone : {true, false}) {
    omp_set_num_threads(alone ? 1 : 3);
    Index least = count;
    std::vector<Index> before(count);
    bool falls = true;
#pragma omp parallel for schedule(static) reduction(&& : falls)
    for (Index i = 0; i < count; ++i) {
      const Index number = (i * 7 + 13) % count - 9, seen = peek(least);
      before[i] = lower_to(least, number, alone);
      falls = falls && before[i] <= seen && peek(least) <= number;
    }
    CHECK(least == -9);
    CHECK(falls);
    std::vector<Index> lowered;  // those that were there when a lower one came
    for (Index i = 0; i < count; ++i)
      if (before[i] > (i * 7 + 13) % count - 9) lowered.push_back(before[i]);
    std::sort(lowered.begin(), lowered.end());
    CHECK(std::adjacent_find(lowered.begin(), lowered.end()) == lowered.end());
    CHECK(lowered.back() == count);
  }
  omp_set_num_threads(threads);
}

TEST_CASE("set sets a flag") {
  Flag flag = 0;
  set(flag);
  CHECK(flag == 1);
  set(flag, Flag(0));
  CHECK(flag == 0);
}

}  // namespace cdem::test
