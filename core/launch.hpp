// launch.hpp - how a kernel meets the machine: items (One, Lane), number packs, for_each, ordered
// sums.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <utility>

#if defined(__AVX__)
#include <immintrin.h>
#endif
#if defined(__CUDACC__)
#include <cuda_runtime.h>
#define CDEM_HD __host__ __device__
#else
// Kernels are small functions over packs of numbers; one that is called and not inlined takes its
// packs through memory.
#define CDEM_HD __attribute__((always_inline))
#endif

namespace cdem {

using Real = double;
using Index = std::int32_t;
using Flag = std::int8_t;

#if !defined(CDEM_LANES)
#define CDEM_LANES 4
#endif

/// Items that one SIMD register holds. The build sets it to match the instruction set: 2, 4 or 8.
inline constexpr Index lanes = CDEM_LANES;

/// How a kernel fetches what it will read.
struct Fetching {
  Index ahead;  // so many blocks
  Index worth;  // if there are as many blocks; fewer leave it in the caches from step to step
};
/// Ask for memory that will be read soon; or written.
CDEM_HD inline void fetch(const void* memory) {
#if !defined(__CUDA_ARCH__)
  __builtin_prefetch(memory);
#endif
}
CDEM_HD inline void fetch_to_write(const void* memory) {
#if !defined(__CUDA_ARCH__)
  __builtin_prefetch(memory, 1);
#endif
}

/// Item of a kernel that runs for one number at a time.
struct One {
  Index i;
};

CDEM_HD inline Real select(bool mask, Real yes, Real no) { return mask ? yes : no; }
CDEM_HD inline Real max_of(Real a, Real b) { return a > b ? a : b; }
CDEM_HD inline Real min_of(Real a, Real b) { return a < b ? a : b; }
CDEM_HD inline Real abs_of(Real a) { return a < 0 ? -a : a; }
CDEM_HD inline Real sqrt_of(Real a) { return std::sqrt(a); }
CDEM_HD inline unsigned lane_bits(bool mask) { return mask; }
CDEM_HD inline bool any_of(bool mask) { return mask; }

/// Is there one thread for all items of a launch?
bool runs_alone();

/// Raise a count that several threads may raise at once, and return what it was. Which of them
/// comes first is left to chance: what is found with it must be sorted. Taking turns costs time,
/// which one thread `alone` need not spend.
CDEM_HD inline Index raise(Index& count, bool alone) {
  if (alone) return count++;
#if defined(__CUDA_ARCH__)
  return atomicAdd(&count, 1);
#else
  return std::atomic_ref(count).fetch_add(1, std::memory_order_relaxed);
#endif
}
/// Set a flag that several threads may set at once.
CDEM_HD inline void set(Flag& flag, Flag value = 1) {
#if defined(__CUDA_ARCH__)
  flag = value;
#else
  std::atomic_ref(flag).store(value, std::memory_order_relaxed);
#endif
}

/// Item of a kernel that picks what it runs for: an item of a row.
struct Picked {
  Index row, id;
};

/// Items of a row: from `first` to before `last`.
struct Range {
  Index first, last;
};

#if !defined(__CUDACC__)

/// Item of a kernel that runs for `lanes` consecutive numbers at once.
struct Lane {
  Index i;
};

/// Outcome of a comparison, lane by lane: all bits set for true.
struct Mask {
  using Bits = std::int64_t __attribute__((vector_size(8 * CDEM_LANES)));
  Bits bits;
  friend Mask operator&(Mask a, Mask b) { return {a.bits & b.bits}; }
  friend Mask operator|(Mask a, Mask b) { return {a.bits | b.bits}; }
  friend Mask operator!(Mask a) { return {~a.bits}; }
};

/// One number per lane. Arithmetic is that of Real, lane by lane, so results do not depend on it.
struct Pack {
  using Numbers = Real __attribute__((vector_size(8 * CDEM_LANES)));
  Numbers n;

  Pack() = default;
  Pack(Numbers numbers) : n(numbers) {}
  Pack(Real number) : n(number - Numbers{}) {}

  friend Pack operator+(Pack a, Pack b) { return {a.n + b.n}; }
  friend Pack operator-(Pack a, Pack b) { return {a.n - b.n}; }
  friend Pack operator*(Pack a, Pack b) { return {a.n * b.n}; }
  friend Pack operator/(Pack a, Pack b) { return {a.n / b.n}; }
  friend Pack operator-(Pack a) { return {-a.n}; }
  friend Mask operator<(Pack a, Pack b) { return {a.n < b.n}; }
  friend Mask operator>(Pack a, Pack b) { return {a.n > b.n}; }
  Pack& operator+=(Pack b) { return *this = *this + b; }
  Pack& operator-=(Pack b) { return *this = *this - b; }
};

inline Pack select(Mask mask, Pack yes, Pack no) { return {mask.bits ? yes.n : no.n}; }
inline Pack max_of(Pack a, Pack b) { return select(a > b, a, b); }
inline Pack min_of(Pack a, Pack b) { return select(a < b, a, b); }
inline Pack abs_of(Pack a) { return select(a < Pack(0.0), -a, a); }
inline Pack sqrt_of(Pack a) {
  Pack root;
  for (Index j = 0; j < lanes; ++j) root.n[j] = std::sqrt(a.n[j]);
  return root;
}
/// The lanes for which a comparison holds, as bits.
inline unsigned lane_bits(Mask mask) {
#if CDEM_LANES == 8
  return _mm512_movepi64_mask((__m512i)mask.bits);
#elif CDEM_LANES == 4
  return unsigned(_mm256_movemask_pd((__m256d)mask.bits));
#else
  unsigned bits = 0;
  for (Index j = 0; j < lanes; ++j) bits |= unsigned(mask.bits[j] & 1) << j;
  return bits;
#endif
}
inline bool any_of(Mask mask) { return lane_bits(mask) != 0; }

/// A pack of what `number` gives for each lane.
template <class Of, Index... lane>
CDEM_HD inline Pack pack_of(const Of& number, std::integer_sequence<Index, lane...>) {
  return {Pack::Numbers{number(lane)...}};
}
template <class Of>
CDEM_HD inline Pack pack_of(const Of& number) {
  return pack_of(number, std::make_integer_sequence<Index, lanes>{});
}

/// One index per lane, as read from a connectivity table.
struct IndexPack {
  Index id[CDEM_LANES];
};

/// As many picked items as there are lanes, whatever rows they are of.
struct PickedLane {
  IndexPack row, id;
};

#endif

/// The number type that a kernel computes with for a type of items or indices: Real for One, Pack
/// for Lane.
template <class Item>
struct NumberOf {
  using type = Real;
};
#if !defined(__CUDACC__)
template <>
struct NumberOf<Lane> {
  using type = Pack;
};
template <>
struct NumberOf<PickedLane> {
  using type = Pack;
};
template <>
struct NumberOf<IndexPack> {
  using type = Pack;
};
#endif
template <class Item>
using Number = typename NumberOf<Item>::type;

/// The index type of a kernel for an item type: Index for One, IndexPack for Lane.
template <class Item>
struct IndexOf {
  using type = Index;
};

#if !defined(__CUDACC__)
template <>
struct IndexOf<Lane> {
  using type = IndexPack;
};
template <>
struct IndexOf<PickedLane> {
  using type = IndexPack;
};
#endif

/// What comparisons of a number type give: bool, Mask.
template <class T>
using Truth = decltype(T() < T());

/// Does a comparison hold for a lane?
CDEM_HD inline bool holds(bool outcome, Index) { return outcome; }
/// The index of a lane.
CDEM_HD inline Index& of_lane(Index& index, Index) { return index; }
CDEM_HD inline Index of_lane(const Index& index, Index) { return index; }
/// Do something for every lane of a picked item, with the number of the lane, row and item.
template <class Do>
CDEM_HD inline void for_lanes(const Picked& item, const Do& act) {
  act(0, item.row, item.id);
}
/// The same for every lane of an item, with the number of the lane and the item.
template <class Do>
CDEM_HD inline void for_lanes(One item, const Do& act) {
  act(0, item.i);
}
#if !defined(__CUDACC__)
CDEM_HD inline bool holds(const Mask& outcome, Index lane) { return outcome.bits[lane] != 0; }
CDEM_HD inline Index& of_lane(IndexPack& index, Index lane) { return index.id[lane]; }
CDEM_HD inline Index of_lane(const IndexPack& index, Index lane) { return index.id[lane]; }
template <class Do>
CDEM_HD inline void for_lanes(const PickedLane& item, const Do& act) {
  for (Index j = 0; j < lanes; ++j) act(j, item.row.id[j], item.id.id[j]);
}
template <class Do>
CDEM_HD inline void for_lanes(Lane item, const Do& act) {
  for (Index j = 0; j < lanes; ++j) act(j, item.i + j);
}
#endif

/// Indices made of indices, lane by lane.
template <class Of, class... Rest>
CDEM_HD inline Index indices_of(const Of& of, Index first, Rest... rest) {
  return of(first, rest...);
}
template <class Of>
CDEM_HD inline Index indices_of(const Of& of, One item) {
  return of(item.i);
}
/// Numbers made of indices, lane by lane.
template <class Of, class... Rest>
CDEM_HD inline Real numbers_of(const Of& of, Index first, Rest... rest) {
  return of(first, rest...);
}
CDEM_HD inline bool differ(Index a, Index b) { return a != b; }
#if !defined(__CUDACC__)
template <class Of, class... Rest>
CDEM_HD inline IndexPack indices_of(const Of& of, const IndexPack& first, const Rest&... rest) {
  IndexPack pack;
  for (Index j = 0; j < lanes; ++j) pack.id[j] = of(first.id[j], rest.id[j]...);
  return pack;
}
template <class Of>
CDEM_HD inline IndexPack indices_of(const Of& of, Lane item) {
  IndexPack pack;
  for (Index j = 0; j < lanes; ++j) pack.id[j] = of(item.i + j);
  return pack;
}
template <class Of, class... Rest>
CDEM_HD inline Pack numbers_of(const Of& of, const IndexPack& first, const Rest&... rest) {
  return pack_of([&](Index j) { return Real(of(first.id[j], rest.id[j]...)); });
}
CDEM_HD inline Mask differ(const IndexPack& a, const IndexPack& b) {
  Mask mask;
  for (Index j = 0; j < lanes; ++j) mask.bits[j] = -std::int64_t(a.id[j] != b.id[j]);
  return mask;
}
#endif

/// Blocks of so many consecutive items that a launch may be limited to.
inline constexpr Index block_size = 8;

/// Numbers of the blocks to run, ascending; all of them where `id` is null.
struct Blocks {
  const Index* id = nullptr;
  Index count = 0;
};

#if defined(__CUDACC__)

inline constexpr Index worth_threads = 1024;  // of host loops

struct Queue {
  cudaStream_t stream = nullptr;
};

template <class Kernel>
__global__ void run_on_gpu(Index count, Kernel kernel) {
  const Index i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) kernel(One{i});
}

/// Run a kernel for every item, one GPU thread each.
template <class Kernel>
void for_each(Queue queue, Index count, const Kernel& kernel) {
  if (count > 0) run_on_gpu<<<(count + 127) / 128, 128, 0, queue.stream>>>(count, kernel);
}
template <class Kernel>
void for_each_one(Queue queue, Index count, const Kernel& kernel) {
  for_each(queue, count, kernel);
}

template <class Kernel>
__global__ void run_picked_on_gpu(Index count, Kernel kernel) {
  const Index row = blockIdx.x * blockDim.x + threadIdx.x;
  if (row >= count) return;
  const Range all = kernel.items(row);
  for (Index id = all.first; id < all.last; ++id)
    if (kernel.picks(row, id)) kernel(Picked{row, id});
}
template <class Kernel>
void for_each_picked(Queue queue, Index count, const Kernel& kernel) {
  if (count > 0) run_picked_on_gpu<<<(count + 127) / 128, 128, 0, queue.stream>>>(count, kernel);
}

template <class Kernel>
__global__ void run_blocks_on_gpu(Index count, Blocks blocks, Kernel kernel) {
  const Index place = blockIdx.x * blockDim.x + threadIdx.x;
  if (place >= blocks.count * block_size) return;
  const Index i = blocks.id[place / block_size] * block_size + place % block_size;
  if (i < count) kernel(One{i});
}
template <class Kernel>
void for_each(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  if (!blocks.id) return for_each(queue, count, kernel);
  const Index threads = blocks.count * block_size;
  if (threads > 0)
    run_blocks_on_gpu<<<(threads + 127) / 128, 128, 0, queue.stream>>>(count, blocks, kernel);
}
template <class Kernel>
void for_each_one(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  for_each(queue, count, blocks, kernel);
}

#else

struct Queue {};

/// Loops over fewer items than this run on one thread: starting the others would cost more.
inline constexpr Index worth_threads = 1024;

/// Run a straight-line kernel for every item: whole lanes, then the remainder one by one.
template <class Kernel>
void for_each(Queue, Index count, const Kernel& kernel) {
  const Index whole = count - count % lanes;
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index i = 0; i < whole; i += lanes) kernel(Lane{i});
  for (Index i = whole; i < count; ++i) kernel(One{i});
}

/// Run a kernel whose items take different paths (searches, ragged sums): one number at a time,
/// dealt out in small parts, for the faces that are in contact lie together.
template <class Kernel>
void for_each_one(Queue, Index count, const Kernel& kernel) {
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
  for (Index i = 0; i < count; ++i) kernel(One{i});
}

/// Run a kernel for what it picks of each of `count` rows: whole lanes, whatever rows their items
/// are of, then each thread's remainder one by one. Picking takes no branch, for none could be
/// foreseen.
template <class Kernel>
void for_each_picked(Queue, Index count, const Kernel& kernel) {
#pragma omp parallel if (count >= worth_threads)
  {
    constexpr Index most = 8 * lanes;
    PickedLane some[most / lanes];
    Index picked = 0;
#pragma omp for schedule(static, 128) nowait
    for (Index row = 0; row < count; ++row) {
      const Range all = kernel.items(row);
      for (Index id = all.first; id < all.last; ++id) {
        some[picked / lanes].row.id[picked % lanes] = row;
        some[picked / lanes].id.id[picked % lanes] = id;
        picked += kernel.picks(row, id) ? 1 : 0;
        if (picked < most) continue;
        for (const PickedLane& lane : some) kernel(lane);
        picked = 0;
      }
    }
    for (Index j = 0; j < picked / lanes; ++j) kernel(some[j]);
    for (Index j = picked - picked % lanes; j < picked; ++j)
      kernel(Picked{some[j / lanes].row.id[j % lanes], some[j / lanes].id.id[j % lanes]});
  }
}

/// Have the kernel fetch what it needs for a block to come, if it knows what the machine does not
/// fetch by itself: what it reads at random, or in too many columns.
template <class Kernel>
CDEM_HD inline void fetch_ahead(const Kernel& kernel, Blocks blocks, Index b) {
  if constexpr (requires { kernel.fetch(One{0}); }) {
    constexpr Fetching how = Kernel::fetching;
    if (blocks.count < how.worth || b + how.ahead >= blocks.count) return;
    const Index first = blocks.id[b + how.ahead] * block_size;
    for (Index i = first; i < first + block_size; ++i) kernel.fetch(One{i});
  }
}

/// The same for some blocks of items.
template <class Kernel>
void for_each(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  static_assert(block_size % lanes == 0);
  if (!blocks.id) return for_each(queue, count, kernel);
  const Index whole = count - count % lanes;
#pragma omp parallel for schedule(static) if (blocks.count * block_size >= worth_threads)
  for (Index b = 0; b < blocks.count; ++b) {
    const Index first = blocks.id[b] * block_size;
    const Index last = first + block_size < count ? first + block_size : count;
    fetch_ahead(kernel, blocks, b);
    Index i = first;
    for (; i < last && i < whole; i += lanes) kernel(Lane{i});
    for (; i < last; ++i) kernel(One{i});
  }
}
template <class Kernel>
void for_each_one(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  if (!blocks.id) return for_each_one(queue, count, kernel);
#pragma omp parallel for schedule(static) if (blocks.count * block_size >= worth_threads)
  for (Index b = 0; b < blocks.count; ++b) {
    const Index first = blocks.id[b] * block_size;
    for (Index i = first; i < first + block_size && i < count; ++i) kernel(One{i});
  }
}

#endif

}  // namespace cdem
