// spare_memory.hpp - memory that was given back and is taken again.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <map>
#include <mutex>
#include <new>
#include <unordered_map>
#include <utility>

namespace cdem {

/// Memory of a source whose own taking and giving back cost more than a launch. Blocks that are
/// given back are kept for others of about their size: up to an eighth of a block is not used.
///
/// `Source::take(bytes)` gives memory or null; `Source::give(memory)` takes it back.
template <class Source>
class SpareMemory {
 public:
  /// Throws std::bad_alloc where the source has no more.
  void* take(std::size_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::size_t size = size_of_block(bytes);
    void* memory = nullptr;
    if (const auto one = spare_.find(size); one != spare_.end()) {
      memory = one->second;
      drop(one);
    } else if (!(memory = Source::take(size))) {
      while (!spare_.empty()) give_largest();
      if (!(memory = Source::take(size))) throw std::bad_alloc();
    }
    used_.emplace(memory, size);
    used_bytes_ += size;
    return memory;
  }
  /// Give back what `take` gave.
  void give(void* memory) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto one = used_.find(memory);
    spare_.emplace(one->second, memory);
    spare_bytes_ += one->second;
    used_bytes_ -= one->second;
    used_.erase(one);
    while (spare_bytes_ > std::max(always, used_bytes_ / 4)) give_largest();
  }

  /// So much may always be kept  [B]; beyond it a quarter of the memory in use.
  static constexpr std::size_t always = std::size_t(64) << 20;

  static std::size_t size_of_block(std::size_t bytes) {
    constexpr std::size_t least = 512;
    const std::size_t step = std::max(std::bit_floor(bytes) / 8, least);
    return std::max((bytes + step - 1) / step * step, least);
  }

 private:
  using Spare = std::multimap<std::size_t, void*>;

  void drop(Spare::iterator one) {
    spare_bytes_ -= one->first;
    spare_.erase(one);
  }
  void give_largest() {
    const auto largest = std::prev(spare_.end());
    Source::give(largest->second);
    drop(largest);
  }

  std::mutex mutex_;
  Spare spare_;
  std::unordered_map<void*, std::size_t> used_;
  std::size_t spare_bytes_ = 0, used_bytes_ = 0;
};

}  // namespace cdem
