// parallel_loops.hpp - the loops behind for_each_lane, for_each_item and for_each_selected.
//
// Only the files of core/kernels include it: each instantiates the loops for the kernels of its
// stage, as C++ for the CPU or as CUDA for a GPU.
#pragma once

#include <type_traits>
#include <typeinfo>

#include "core/base/answer.hpp"
#include "core/base/any_item.hpp"
#include "core/base/emulated.hpp"
#include "core/base/parallel.hpp"
#include "core/base/prefetch.hpp"
#include "core/base/threads.hpp"

namespace cdem {

#if defined(CDEM_CUDA)

/// Put a launch of some groups of threads into the queue.
template <class Run, class... Arguments>
void launch_groups(Queue queue, Index groups, Index together, Run* run,
                   const Arguments&... arguments) {
  run<<<groups, together, 0, static_cast<cudaStream_t>(queue.stream)>>>(arguments...);
  check(cudaGetLastError());
}
/// The same of a thread for each of `count` items.
template <class Run, class... Arguments>
void launch(Queue queue, Index count, Run* run, const Arguments&... arguments) {
  constexpr Index together = 128;
  const Index groups = count / together + (count % together > 0);
  if (count > 0) launch_groups(queue, groups, together, run, arguments...);
}

template <class Kernel>
__global__ void run_on_gpu(Index count, Kernel kernel) {
  const Index i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) kernel(One{i});
}

/// Run a kernel for every item, one GPU thread each.
template <class Kernel>
void for_each_lane(Queue queue, Index count, const Kernel& kernel) {
  launch(queue, count, run_on_gpu<Kernel>, count, kernel);
}
template <class Kernel>
void for_each_item(Queue queue, Index count, const Kernel& kernel) {
  for_each_lane(queue, count, kernel);
}

template <class Kernel>
__global__ void run_selected_on_gpu(Index count, Kernel kernel) {
  const Index row = blockIdx.x * blockDim.x + threadIdx.x;
  if (row >= count) return;
  const Range all = kernel.items(row);
  for (Index id = all.first; id < all.last; ++id)
    if (kernel.selects(row, id)) kernel(Selected{row, id});
}
template <class Kernel>
void for_each_selected(Queue queue, Index count, const Kernel& kernel) {
  launch(queue, count, run_selected_on_gpu<Kernel>, count, kernel);
}

template <class Kernel>
__global__ void run_blocks_on_gpu(Index count, Blocks blocks, Kernel kernel) {
  const Index place = blockIdx.x * blockDim.x + threadIdx.x;
  if (place >= blocks.count_in(count) * block_size) return;
  const Index i = blocks.first(place / block_size) + place % block_size;
  if (i < count) kernel(One{i});
}
template <class Kernel>
void for_each_lane(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  const Index threads = blocks.count_in(count) * block_size;
  launch(queue, threads, run_blocks_on_gpu<Kernel>, count, blocks, kernel);
}
template <class Kernel>
void for_each_item(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  for_each_lane(queue, count, blocks, kernel);
}

#elif defined(CDEM_EMULATED)

/// Launch the work of a copy of a kernel, which is all that a device has of it.
template <class Kernel, class Work>
void launch(Index count, const Kernel& kernel, const Work& work) {
  const auto own = [kernel, work](Index i) { work(kernel, i); };
  static_assert(std::is_trivially_destructible_v<decltype(own)>);
  const auto run = [](const void* of, Index i) { (*static_cast<decltype(own)*>(of))(i); };
  if (count > 0) launch(count, typeid(Kernel).name(), run, &own, sizeof own);
}

template <class Kernel>
void for_each_lane(Queue, Index count, const Kernel& kernel) {
  launch(count, kernel, [](const Kernel& own, Index i) { own(One{i}); });
}
template <class Kernel>
void for_each_item(Queue queue, Index count, const Kernel& kernel) {
  for_each_lane(queue, count, kernel);
}

template <class Kernel>
void for_each_selected(Queue, Index count, const Kernel& kernel) {
  launch(count, kernel, [](const Kernel& own, Index row) {
    const Range all = own.items(row);
    for (Index id = all.first; id < all.last; ++id)
      if (own.selects(row, id)) own(Selected{row, id});
  });
}

template <class Kernel>
void for_each_lane(Queue, Index count, Blocks blocks, const Kernel& kernel) {
  launch(blocks.count_in(count) * block_size, kernel, [=](const Kernel& own, Index place) {
    const Index i = blocks.first(place / block_size) + place % block_size;
    if (i < count) own(One{i});
  });
}
template <class Kernel>
void for_each_item(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  for_each_lane(queue, count, blocks, kernel);
}

#else

/// One of the few items that fill no lane: built for size, as half of the time that kernels took to
/// build went into it. It has a copy, or the kernel's numbers would be read again after each call.
template <class Kernel>
[[gnu::cold, gnu::noinline]] void run_one(Kernel kernel, Index i) {
  kernel(One{i});
}

template <class Kernel>
bool any_item(Queue, Index count, const Kernel& kernel) {
  constexpr bool packs = requires { kernel(Lane{0}); };
  using Item = std::conditional_t<packs, Lane, One>;
  constexpr Index size = packs ? lanes : 1;
  Flag found = 0;
  on_threads(count >= worth_threads, [&](Thread thread) {
    const Range part = thread.part_of(count / size);
    decltype(kernel(Item{0})) own{};
    for (Index k = part.first; k < part.last; ++k) own = own | kernel(Item{k * size});
    if (any_of(own)) set(found);
  });
  for (Index i = count - count % size; i < count; ++i)
    if (any_of(kernel(One{i}))) found = 1;
  return found != 0;
}
template <class Kernel>
void raise_if_any(Queue queue, Index count, const Kernel& kernel, Flag* flag) {
  if constexpr (requires { kernel.quicker(); })
    if (!any_item(queue, count, kernel.quicker())) return;
  if (any_item(queue, count, kernel)) *flag = 1;
}

/// Run a straight-line kernel for every item: whole lanes, then the remainder one by one.
template <class Kernel>
void for_each_lane(Queue, Index count, const Kernel& kernel) {
  on_threads(count >= worth_threads, [&](Thread thread) {
    const Range part = thread.part_of(count / lanes);
    for (Index k = part.first; k < part.last; ++k) kernel(Lane{k * lanes});
  });
  for (Index i = count - count % lanes; i < count; ++i) run_one(kernel, i);
}

/// Run a kernel whose items take different paths (searches, ragged sums): one number at a time,
/// in small parts for each thread, as the faces that are in contact lie together.
template <class Kernel>
void for_each_item(Queue, Index count, const Kernel& kernel) {
  on_threads(count >= worth_threads, [&](Thread thread) {
    thread.deal(count, 128, [&](Index first, Index last) {
      for (Index i = first; i < last; ++i) kernel(One{i});
    });
  });
}

/// Run a kernel for the items that it selects of each of `count` rows: whole lanes with items of
/// any rows, then each thread's remainder one by one. Selection takes no branch, for the processor
/// could not predict it.
template <class Kernel>
void for_each_selected(Queue, Index count, const Kernel& kernel) {
  on_threads(count >= worth_threads, [&](Thread thread) {
    constexpr unsigned size = lanes, most = 8 * size;  // unsigned: shifts and masks divide
    SelectedLane some[most / size];
    unsigned selected = 0;
    thread.deal(count, 128, [&](Index first, Index last) {
      unsigned chosen = selected;  // in a register: each item waits for the number before it
      for (Index row = first; row < last; ++row) {
        const Range all = kernel.items(row);
        for (Index id = all.first; id < all.last; ++id) {
          some[chosen / size].row.id[chosen % size] = row;
          some[chosen / size].id.id[chosen % size] = id;
          chosen += kernel.selects(row, id) ? 1 : 0;
          if (chosen < most) continue;
          for (const SelectedLane& lane : some) kernel(lane);
          chosen = 0;
        }
      }
      selected = chosen;
    });
    for (unsigned j = 0; j < selected / size; ++j) kernel(some[j]);
    for (unsigned j = selected - selected % size; j < selected; ++j)
      kernel(Selected{some[j / size].row.id[j % size], some[j / size].id.id[j % size]});
  });
}

/// Have the kernel fetch what it needs for a block to come, if it knows what the machine does not
/// fetch by itself: what it reads at random, or in too many columns.
template <class Kernel>
CDEM_HD inline void fetch_ahead(const Kernel& kernel, Blocks blocks, Index b) {
  if constexpr (requires { kernel.fetch(One{0}); }) {
    constexpr Fetching how = Kernel::fetching;
    if (!blocks.id || blocks.count < how.worth || b + how.ahead >= blocks.count) return;
    const Index first = blocks.first(b + how.ahead);
    for (Index i = first; i < first + block_size; ++i) kernel.fetch(One{i});
  }
}

/// The same for some blocks of items.
template <class Kernel>
void for_each_lane(Queue, Index count, Blocks blocks, const Kernel& kernel) {
  static_assert(block_size % lanes == 0);
  const Index whole = count - count % lanes, number = blocks.count_in(count);
  on_threads(number * block_size >= worth_threads, [&](Thread thread) {
    const Range part = thread.part_of(number);
    for (Index b = part.first; b < part.last; ++b) {
      const Index first = blocks.first(b);
      const Index last = first + block_size < count ? first + block_size : count;
      fetch_ahead(kernel, blocks, b);
      Index i = first;
      for (; i < last && i < whole; i += lanes) kernel(Lane{i});
      for (; i < last; ++i) run_one(kernel, i);
    }
  });
}
template <class Kernel>
void for_each_item(Queue, Index count, Blocks blocks, const Kernel& kernel) {
  const Index number = blocks.count_in(count);
  on_threads(number * block_size >= worth_threads, [&](Thread thread) {
    const Range part = thread.part_of(number);
    for (Index b = part.first; b < part.last; ++b) {
      const Index first = blocks.first(b);
      for (Index i = first; i < first + block_size && i < count; ++i) kernel(One{i});
    }
  });
}

#endif

#if !defined(CDEM_CPU)

/// Sets a flag where a kernel holds.
template <class Kernel>
struct SetWhere {
  Kernel holds;
  Flag* found;
  CDEM_HD void operator()(One item) const {
    if (holds(item)) set(*found);
  }
};

template <class Kernel>
void raise_if_any(Queue queue, Index count, const Kernel& kernel, Flag* flag) {
  if (count > 0) for_each_item(queue, count, SetWhere<Kernel>{kernel, flag});
}
template <class Kernel>
bool any_item(Queue queue, Index count, const Kernel& kernel) {
  if (count == 0) return false;
  Answer<Flag>& found = answer_of_thread<Flag>();
  found.set(queue, 0);
  raise_if_any(queue, count, kernel, found.data());
  return found.read(queue) != 0;
}

#endif

}  // namespace cdem
