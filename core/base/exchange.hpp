// exchange.hpp - how the ranks of one model talk.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/lanes.hpp"

namespace cdem {

/// Ranks run one model together, a part each. All call the same functions in the same order, and
/// wait there for each other.
class Exchange {
 public:
  virtual ~Exchange() = default;

  /// How many ranks there are.
  virtual int count() const = 0;
  /// Words become their sums over all ranks.
  virtual void add_up(std::int64_t* words, Index count) = 0;
  /// Bytes of all ranks, one rank after the other.
  virtual void gather(const void* own, std::size_t bytes, void* all) = 0;
  /// Send rows of so many numbers to the ranks that need them, and receive rows of theirs. Which
  /// rows those are is agreed beforehand.
  virtual void swap(const Real* send, Index sent, Real* receive, Index received, Index numbers) = 0;
};

/// Items that count for a rank, and the ranks that count the others. Of a whole model all count.
struct Counted {
  const Flag* own = nullptr;  // [item]; null: all
  Exchange* ranks = nullptr;  // null: there is one
};

}  // namespace cdem
