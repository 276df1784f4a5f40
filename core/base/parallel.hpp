// parallel.hpp - run a kernel for many items: lane by lane, one by one, or for those it selects.
#pragma once

#include <algorithm>

#include "core/base/device.hpp"
#include "core/base/lanes.hpp"
#include "core/base/sorted.hpp"

namespace cdem {

/// Loops over fewer items than this run on one thread: starting the others would cost more. A build
/// that looks for races (`tools/build.py --sanitize thread`) starts them for every loop.
#if defined(CDEM_ALWAYS_THREADS)
inline constexpr Index worth_threads = 1;
#else
inline constexpr Index worth_threads = 1024;
#endif

/// Blocks of so many consecutive items that a launch may be limited to.
inline constexpr Index block_size = 8;

/// Numbers of the blocks to run, ascending; all of them where `id` is null.
struct Blocks {
  const Index* id = nullptr;
  Index count = 0;

  /// How many blocks of `items` items are run.
  CDEM_HD Index count_in(Index items) const {
    return id ? count : items / block_size + (items % block_size > 0);
  }
  /// First item of the b-th of them.
  CDEM_HD Index first(Index b) const { return (id ? id[b] : b) * block_size; }
  /// Is a block among them?
  CDEM_HD bool has(Index block) const { return !id || is_among(id, count, block); }
  /// Which of them have numbers from `begin` to before `end`.
  CDEM_HD Range between(Index begin, Index end) const {
    if (!id) return {begin, end};
    return {first_from(id, count, begin), first_from(id, count, end)};
  }
};

/// Raise a count that several threads may raise at once, and return its old value. Which of them
/// comes first is left to chance: results found with it must be sorted. An atomic costs time, which
/// one thread `alone` need not spend. Not std::atomic_ref, which libc++ lacks before version 19.
CDEM_HD inline Index raise(Index& count, bool alone) {
  if (alone) return count++;
#if defined(__CUDA_ARCH__)
  return atomicAdd(&count, 1);
#else
  return __atomic_fetch_add(&count, 1, __ATOMIC_RELAXED);
#endif
}
/// Set bits of a word that several threads may set at once.
CDEM_HD inline void raise_bits(std::uint64_t& word, std::uint64_t bits, bool alone) {
  if (alone) {
    word |= bits;
    return;
  }
#if defined(__CUDA_ARCH__)
  atomicOr(reinterpret_cast<unsigned long long*>(&word), bits);
#else
  __atomic_fetch_or(&word, bits, __ATOMIC_RELAXED);
#endif
}
/// Raise a number that is not negative to another one, where several threads may at once.
CDEM_HD inline void raise_to(Real& most, Real value, bool alone) {
  if (alone) {
    if (value > most) most = value;
    return;
  }
#if defined(__CUDA_ARCH__)  // such numbers are in the order of their bits
  atomicMax(reinterpret_cast<long long*>(&most), __double_as_longlong(value));
#else
  Real now = 0;  // a guess: the failed exchange tells
  while (now < value && !__atomic_compare_exchange(&most, &now, &value, true, __ATOMIC_RELAXED,
                                                   __ATOMIC_RELAXED)) {
  }
#endif
}
/// The same down.
CDEM_HD inline void lower_to(Real& least, Real value, bool alone) {
  if (alone) {
    if (value < least) least = value;
    return;
  }
#if defined(__CUDA_ARCH__)
  atomicMin(reinterpret_cast<long long*>(&least), __double_as_longlong(value));
#else
  Real now = infinity;
  while (now > value && !__atomic_compare_exchange(&least, &now, &value, true, __ATOMIC_RELAXED,
                                                   __ATOMIC_RELAXED)) {
  }
#endif
}
/// The same of an index, which may be negative; returns its old value.
CDEM_HD inline Index lower_to(Index& least, Index value, bool alone) {
  if (alone) {
    const Index before = least;
    if (value < before) least = value;
    return before;
  }
#if defined(__CUDA_ARCH__)
  return atomicMin(&least, value);
#else
  Index now = __atomic_load_n(&least, __ATOMIC_RELAXED);
  while (now > value && !__atomic_compare_exchange(&least, &now, &value, true, __ATOMIC_RELAXED,
                                                   __ATOMIC_RELAXED)) {
  }
  return now;
#endif
}
/// Read an index that several threads may lower at once: any of the values that it has meanwhile.
CDEM_HD inline Index peek(const Index& index) {
#if defined(__CUDA_ARCH__)
  return *static_cast<const volatile Index*>(&index);
#else
  return __atomic_load_n(&index, __ATOMIC_RELAXED);
#endif
}
/// Set a flag that several threads may set at once.
CDEM_HD inline void set(Flag& flag, Flag value = 1) {
#if defined(__CUDA_ARCH__)
  flag = value;
#else
  __atomic_store_n(&flag, value, __ATOMIC_RELAXED);
#endif
}

/// Run a kernel for `count` items; straight-line kernels go lane by lane. Instantiated for every
/// kernel in core/kernels.
template <class Kernel>
void for_each_lane(Queue queue, Index count, const Kernel& kernel);

/// The same for kernels whose items take different paths.
template <class Kernel>
void for_each_item(Queue queue, Index count, const Kernel& kernel);

/// The same for kernels that select their items: of the `items(row)` of each of `count` rows
/// the ones that it `selects(row, id)`. Selected items are packed into lanes.
template <class Kernel>
void for_each_selected(Queue queue, Index count, const Kernel& kernel);

/// The same for some blocks of the items.
template <class Kernel>
void for_each_lane(Queue queue, Index count, Blocks blocks, const Kernel& kernel);
template <class Kernel>
void for_each_item(Queue queue, Index count, Blocks blocks, const Kernel& kernel);

}  // namespace cdem
