// Threads: parts of items and runs that are dealt cover each item once, whatever the threads.
#include <doctest/doctest.h>

#include <vector>

#include "core/base/threads.hpp"

namespace cdem::test {

TEST_CASE("parts of all threads follow each other and cover all items") {
  for (const Index items : {0, 1, 7, 128, 1000})
    for (const Index count : {1, 2, 3, 7}) {
      Index next = 0;
      for (Index number = 0; number < count; ++number) {
        const Range part = Thread{number, count}.part_of(items);
        CHECK(part.first == next);
        CHECK(part.last - part.first <= items / count + 1);
        next = part.last;
      }
      CHECK(next == items);
    }
}

TEST_CASE("runs are dealt in turn and cover each item once") {
  for (const Index count : {1, 2, 3}) {
    std::vector<Index> seen(1000);
    for (Index number = 0; number < count; ++number)
      Thread{number, count}.deal(1000, 128, [&](Index first, Index last) {
        CHECK(first / 128 % count == number);
        for (Index i = first; i < last; ++i) ++seen[i];
      });
    CHECK(seen == std::vector<Index>(1000, 1));
  }
}

TEST_CASE("work on one thread is alone, and else has all numbers") {
  for (const bool several : {false, true}) {
    std::vector<Index> calls(256);
    Index threads = 0;
    cdem::on_threads(several, [&](Thread thread) {
      ++calls[thread.number];
      if (thread.number == 0) threads = thread.count;
    });
    CHECK((several || threads == 1));
    for (Index number = 0; number < 256; ++number) CHECK(calls[number] == (number < threads));
  }
}

}  // namespace cdem::test
