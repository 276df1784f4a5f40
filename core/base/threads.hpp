// threads.hpp - share work among threads, or do it on this one.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/lanes.hpp"

namespace cdem {

/// One of the threads that share work.
struct Thread {
  Index number, count;

  /// Its part of some items; those of all threads are of about one size, in order.
  Range part_of(Index items) const { return {start(items, number), start(items, number + 1)}; }
  /// Call run(first, last) for its part of some items that are dealt in runs of a `size`.
  template <class Run>
  void deal(Index items, Index size, const Run& run) const {
    const std::int64_t all = items;
    for (std::int64_t first = std::int64_t(number) * size; first < all;
         first += std::int64_t(count) * size)
      run(Index(first), Index(std::min(first + size, all)));
  }

 private:
  Index start(Index items, Index part) const { return Index(std::int64_t(items) * part / count); }
};

/// Call work(of, thread) on all threads, or on this one alone.
void on_threads(bool several, void (*work)(const void* of, Thread thread), const void* of);

/// Call work(thread) on all threads, or on this one where several are not worth it. A region of
/// OpenMP takes memory and calls the system even on a single thread: half of a step of few blocks.
template <class Work>
void on_threads(bool several, const Work& work) {
  const auto call = [](const void* of, Thread thread) { (*static_cast<const Work*>(of))(thread); };
  on_threads(several, call, &work);
}

}  // namespace cdem
