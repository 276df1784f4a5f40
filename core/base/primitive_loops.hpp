// primitive_loops.hpp - the templates behind primitives.hpp. Only the files of core/kernels include
// it.
#pragma once

#include <algorithm>
#include <exception>
#include <vector>

#include "core/base/exact_sum.hpp"
#include "core/base/openmp.hpp"
#include "core/base/parallel_loops.hpp"
#include "core/base/primitives.hpp"
#include "core/base/uninitialized.hpp"

namespace cdem {

#if !defined(CDEM_CUDA)

/// Parts of some items, in order and of about one size.
struct Parts {
  Index items, count;

  Range at(Index part) const { return {start(part), start(part + 1)}; }
  /// Call run(part, range) for each, on a thread of its own.
  template <class Run>
  void for_each(const Run& run) const {
    on_threads(count > 1, [&](Thread thread) {
      thread.deal(count, 1, [&](Index part, Index) { run(part, at(part)); });
    });
  }

 private:
  Index start(Index part) const { return Index(std::int64_t(items) * part / count); }
};
/// One for each thread where there are at least so many items.
inline Parts parts_of(Index items, Index worth) {
  return {items, items >= worth ? Index(omp_get_max_threads()) : 1};
}

#endif

/// Temporary memory of a primitive; one of a kind for each thread of the host. It is
/// never released: the device may be gone by then.
template <class T>
T* scratch(std::size_t size) {
  static thread_local Column<T>& column = *new Column<T>;
  column.renew(size);
  return column.data();
}

template <class T>
struct SetItem {
  T* items;
  T value;
  CDEM_HD void operator()(One item) const { items[item.i] = value; }
};
template <class T>
void set_all(Queue queue, Index count, T* items, T value) {
  for_each_item(queue, count, SetItem<T>{items, value});
}

template <class T>
struct CopyItem {
  const T* from;
  T* into;
  CDEM_HD void operator()(One item) const { into[item.i] = from[item.i]; }
};
template <class T>
void copy_items(Queue queue, Index count, const T* from, T* into) {
  for_each_item(queue, count, CopyItem<T>{from, into});
}

#if defined(CDEM_CPU)

template <class Kernel>
void find_most(Queue, Index count, const Kernel& kernel, const Flag* own_items,
               Answer<Most>& answer) {
  Most all;
  on_threads(count >= worth_threads, [&](Thread thread) {
    Most own;
    const Range part = thread.part_of(count);
    for (Index i = part.first; i < part.last; ++i)
      if (!own_items || own_items[i]) own.meet(kernel(One{i}), i);
#pragma omp critical(cdem_most)
    all.meet(own.value, own.item);
  });
  *answer.data() = all;
}

template <class Kernel>
Real exact_sum(Queue, Index count, const Kernel& kernel, const Counted& counted) {
  constexpr Index chunk = ExactSum::most;
  ExactSum all;
  on_threads(count >= worth_threads, [&](Thread thread) {
    ExactSum own;
    alignas(64) Real numbers[chunk];
    const Range part = thread.part_of(count / chunk + (count % chunk > 0));
    for (Index c = part.first; c < part.last; ++c) {
      const Index first = c * chunk, here = std::min(chunk, count - first);
      for (Index i = 0; i < here; ++i) numbers[i] = kernel(One{first + i});
      for (Index i = 0; counted.own && i < here; ++i)
        if (!counted.own[first + i]) numbers[i] = 0;
      own.add(numbers, here);
    }
#pragma omp critical(cdem_exact_sum)
    all.add(own);
  });
  all.add_ranks(counted.ranks);
  return all.value();
}

template <class Kernel>
void select_items(Queue, Index count, const Kernel& kernel, Column<Index>& list) {
  const Parts parts = parts_of(count, worth_threads);
  std::vector<Index> found(parts.count);
  list.renew(count);
  Index* const items = list.data();
  parts.for_each([&](Index p, Range part) {
    Index next = part.first;
    for (Index i = part.first; i < part.last; ++i) {
      items[next] = i;  // no branch, for the processor could not predict it
      next += kernel(One{i}) ? 1 : 0;
    }
    found[p] = next - part.first;
  });
  Index all = found[0];
  for (Index p = 1; p < parts.count; all += found[p++])
    std::copy_n(items + parts.at(p).first, found[p], items + all);
  list.renew(all);
}

/// Parts of items that take different times: several for each thread.
inline Parts uneven_parts_of(Index items) {
  constexpr Index a_thread = 16;
  const Index threads = parts_of(items, worth_threads).count;
  return {items, threads > 1 ? a_thread * threads : 1};
}

template <class Item, class Kernel>
void list_items_from(Queue, Index rows, const Kernel& kernel, Index* first, Column<Item>& items) {
  const Parts parts = uneven_parts_of(rows);
  std::vector<Unset<Item>> found(parts.count);
  std::exception_ptr failure;  // memory may run out, and no exception may leave a parallel loop
  parts.for_each([&](Index p, Range part) {
    try {
      const auto act = [&own = found[p]](const Item& item) { own.push_back(item); };
      for (Index row = part.first; row < part.last; ++row) {
        first[row] = Index(found[p].size());
        kernel.visit(One{row}, act);
      }
    } catch (...) {
#pragma omp critical(cdem_list_items)
      failure = std::current_exception();
    }
  });
  if (failure) std::rethrow_exception(failure);
  std::vector<std::size_t> before(parts.count + 1);
  for (Index p = 0; p < parts.count; ++p) before[p + 1] = before[p] + found[p].size();
  items.renew(before.back());
  parts.for_each([&](Index p, Range part) {
    for (Index row = part.first; row < part.last; ++row) first[row] += Index(before[p]);
    std::copy(found[p].begin(), found[p].end(), items.data() + before[p]);
    found[p] = {};
  });
  first[rows] = Index(before.back());
}

template <class Item, class Kernel>
void keep_items(Queue, const Kernel& kernel, Column<Item>& items) {
  const Parts parts = uneven_parts_of(Index(items.size()));
  std::vector<Index> kept(parts.count);
  Item* const list = items.data();
  parts.for_each([&](Index p, Range part) {
    Index next = part.first;
    for (Index i = part.first; i < part.last; ++i) {
      Item item = list[i];
      const bool holds = kernel(item);
      list[next] = item;
      next += holds ? 1 : 0;
    }
    kept[p] = next - part.first;
  });
  Index all = kept[0];
  for (Index p = 1; p < parts.count; all += kept[p++])
    std::copy_n(list + parts.at(p).first, kept[p], list + all);
  items.renew(all);
}

#else

/// The same of numbers.
void find_most_of(Queue queue, Index count, const Real* values, Most* answer);

/// Other numbers of items that are not own, if there are any (null: there are none).
template <class Kernel>
struct SetValue {
  Kernel kernel;
  const Flag* own;
  Real other;
  Real* values;
  CDEM_HD void operator()(One item) const {
    const Real value = kernel(item);
    values[item.i] = !own || own[item.i] ? value : other;
  }
};
template <class Kernel>
void find_most(Queue queue, Index count, const Kernel& kernel, const Flag* own,
               Answer<Most>& answer) {
  if (count == 0) return answer.set(queue, {});
  Real* const values = scratch<Real>(count);
  for_each_item(queue, count, SetValue<Kernel>{kernel, own, -infinity, values});
  find_most_of(queue, count, values, answer.data());
}

#if defined(CDEM_CUDA)

inline constexpr int sum_warp = 32, sum_threads = 256;
inline constexpr Index sum_groups = 1024;

/// Of all threads of a warp, which call it together.
__device__ inline int most_of_warp(int number) { return __reduce_max_sync(~0u, number); }
/// The same for a digit, which has up to 32 bits and a sign.
__device__ inline std::int64_t sum_of_warp(std::int64_t digit) {
  const int low = __reduce_add_sync(~0u, int(digit & 0xffff));
  const int high = __reduce_add_sync(~0u, int(digit >> 16));
  return std::int64_t(high) * 0x10000 + low;
}

/// Add a number of each item to the words of a sum: digit by digit in warps, which have a sum each,
/// then these.
template <class Kernel>
__global__ void sum_on_gpu(Index count, Kernel kernel, std::int64_t* words) {
  __shared__ std::int64_t own[sum_threads / sum_warp][ExactSum::words];
  const int warp = threadIdx.x / sum_warp, lane = threadIdx.x % sum_warp;
  for (int k = lane; k < ExactSum::words; k += sum_warp) own[warp][k] = 0;
  __syncwarp();
  const std::int64_t step = std::int64_t(gridDim.x) * sum_threads;
  std::int64_t first = std::int64_t(blockIdx.x) * sum_threads + warp * sum_warp;
  for (; first < count; first += step) {
    const NumberDigits digits(first + lane < count ? kernel(One{Index(first + lane)}) : 0.0);
    int k = most_of_warp(digits.below(ExactSum::words));
    for (; k >= 0; k = most_of_warp(digits.below(k))) {
      const std::int64_t sum = sum_of_warp(digits.at(k));
      if (lane == 0) own[warp][k] += sum;
    }
  }
  __syncthreads();
  for (int k = threadIdx.x; k < ExactSum::words; k += sum_threads) {
    std::int64_t sum = 0;
    for (const auto& part : own) sum += part[k];
    if (sum != 0) atomicAdd(reinterpret_cast<unsigned long long*>(words + k), sum);
  }
}

/// Words of a sum, initially zero, and the sum of all terms added.
std::int64_t* zeroed_words(Queue queue);
Real sum_of_words(Queue queue, const std::int64_t* words, Exchange* ranks);

template <class Kernel>
Real exact_sum(Queue queue, Index count, const Kernel& kernel, const Counted& counted) {
  if (count == 0 && !counted.ranks) return 0;
  if (counted.own) {  // in two steps: a kernel that asked which count would need more registers
    Real* const values = scratch<Real>(count);
    for_each_item(queue, count, SetValue<Kernel>{kernel, counted.own, 0, values});
    return exact_sum(queue, count, EachNumber<>{values}, Counted{nullptr, counted.ranks});
  }
  std::int64_t* const words = zeroed_words(queue);
  const Index groups = std::min(sum_groups, count / sum_threads + (count % sum_threads > 0));
  if (groups > 0)
    launch_groups(queue, groups, sum_threads, sum_on_gpu<Kernel>, count, kernel, words);
  return sum_of_words(queue, words, counted.ranks);
}

#else

/// The same of numbers.
Real exact_sum_of(Queue queue, Index count, const Real* values, Exchange* ranks);

template <class Kernel>
Real exact_sum(Queue queue, Index count, const Kernel& kernel, const Counted& counted) {
  if (count == 0 && !counted.ranks) return 0;
  Real* const values = scratch<Real>(count);
  for_each_item(queue, count, SetValue<Kernel>{kernel, counted.own, 0, values});
  return exact_sum_of(queue, count, values, counted.ranks);
}

#endif

template <class Kernel>
struct CountItem {
  Kernel holds;
  Index* count;
  CDEM_HD void operator()(One item) const { count[item.i] = holds(item) ? 1 : 0; }
};
struct PutCounted {
  const Index* first;
  Index* list;
  CDEM_HD void operator()(One item) const {
    if (first[item.i] < first[item.i + 1]) list[first[item.i]] = item.i;
  }
};
template <class Kernel>
void select_items(Queue queue, Index count, const Kernel& kernel, Column<Index>& list) {
  if (count == 0) return list.renew(0);
  Index* const first = scratch<Index>(std::size_t(count) + 1);
  for_each_item(queue, count, CountItem<Kernel>{kernel, first + 1});
  list.renew(scan(queue, count, first + 1, first));
  for_each_item(queue, count, PutCounted{first, list.data()});
}

template <class Item, class Kernel>
struct CountVisited {
  Kernel kernel;
  Index* count;
  CDEM_HD void operator()(One row) const {
    Index visited = 0;
    kernel.visit(row, [&](const Item&) { ++visited; });
    count[row.i] = visited;
  }
};
template <class Item, class Kernel>
struct PutVisited {
  Kernel kernel;
  const Index* first;
  Item* items;
  CDEM_HD void operator()(One row) const {
    Index place = first[row.i];
    kernel.visit(row, [&](const Item& item) { items[place++] = item; });
  }
};
template <class Item, class Kernel>
void list_items_from(Queue queue, Index rows, const Kernel& kernel, Index* first,
                     Column<Item>& items) {
  for_each_item(queue, rows, CountVisited<Item, Kernel>{kernel, first + 1});
  items.renew(scan(queue, rows, first + 1, first));
  for_each_item(queue, rows, PutVisited<Item, Kernel>{kernel, first, items.data()});
}

template <class Item, class Kernel>
struct CountKept {
  Kernel holds;
  Item* items;
  Index* count;
  CDEM_HD void operator()(One i) const { count[i.i] = holds(items[i.i]) ? 1 : 0; }
};
template <class Item>
struct PutKept {
  const Index* first;
  const Item* items;
  Item* kept;
  CDEM_HD void operator()(One i) const {
    if (first[i.i] < first[i.i + 1]) kept[first[i.i]] = items[i.i];
  }
};
template <class Item, class Kernel>
void keep_items(Queue queue, const Kernel& kernel, Column<Item>& items) {
  const Index count = Index(items.size());
  if (count == 0) return;
  Index* const first = scratch<Index>(std::size_t(count) + 1);
  for_each_item(queue, count, CountKept<Item, Kernel>{kernel, items.data(), first + 1});
  Column<Item> kept;
  kept.renew(scan(queue, count, first + 1, first));
  for_each_item(queue, count, PutKept<Item>{first, items.data(), kept.data()});
  items.swap(kept);
}

#endif

template <class Kernel>
Most most(Queue queue, Index count, const Kernel& kernel, const Flag* own) {
  Answer<Most>& answer = answer_of_thread<Most>();
  find_most(queue, count, kernel, own, answer);
  return answer.read(queue);
}

template <class Item, class Kernel>
void list_items(Queue queue, Index rows, const Kernel& kernel, Column<Item>& items) {
  if (rows == 0) return items.renew(0);
  list_items_from(queue, rows, kernel, scratch<Index>(std::size_t(rows) + 1), items);
}
template <class Item, class Kernel>
void list_items(Queue queue, Index rows, const Kernel& kernel, Column<Index>& first,
                Column<Item>& items) {
  first.renew(std::size_t(rows) + 1);
  list_items_from(queue, rows, kernel, first.data(), items);
}

/// Count the numbers of every row; each number learns its place there, in any order.
template <class Kernel>
struct CountInRows {
  Kernel kernel;
  Index *count, *place;
  bool alone;  // see raise
  CDEM_HD void operator()(One item) const {
    kernel.visit(item, [&](Index row, Index number) { place[number] = raise(count[row], alone); });
  }
};
template <class Kernel>
struct PutInRows {
  Kernel kernel;
  const Index *place, *first;
  Index* list;
  CDEM_HD void operator()(One item) const {
    kernel.visit(item, [&](Index row, Index number) { list[first[row] + place[number]] = number; });
  }
};
/// Sort every row.
template <class Kernel>
struct SortRow {
  Kernel kernel;
  const Index* first;
  Index* list;
  CDEM_HD void operator()(One row) const {
    const Index count = first[row.i + 1] - first[row.i];
    if (count > 1) sort(list + first[row.i], count);
  }

 private:
  /// Shell's sort: rows are short and almost in order, but for a few long ones.
  CDEM_HD void sort(Index* row, Index count) const {
    Index gap = 1;
    while (gap < count / 3) gap = 3 * gap + 1;
    for (; gap > 0; gap /= 3)
      for (Index j = gap; j < count; ++j) {
        const Index one = row[j];
        Index place = j;
        for (; place >= gap && is_before(one, row[place - gap]); place -= gap)
          row[place] = row[place - gap];
        row[place] = one;
      }
  }
  CDEM_HD bool is_before(Index one, Index other) const {
    if constexpr (requires { kernel.is_before(one, other); })
      return kernel.is_before(one, other);
    else
      return one < other;
  }
};

/// Count the numbers of rows in first + 1; returns the place of every number in its row.
template <class Kernel>
Index* count_in_rows(Queue queue, Index items, Index numbers, Index rows, const Kernel& kernel,
                     Column<Index>& first) {
  first.renew(std::size_t(rows) + 1);
  Index *const starts = first.data(), *const place = scratch<Index>(numbers);
  set_all(queue, rows + 1, starts, Index(0));
  for_each_item(queue, items,
                CountInRows<Kernel>{
                    .kernel = kernel, .count = starts + 1, .place = place, .alone = runs_alone()});
  return place;
}
template <class Kernel>
void put_in_rows(Queue queue, Index items, Index rows, const Kernel& kernel, const Index* place,
                 const Index* first, Index* list) {
  for_each_item(queue, items,
                PutInRows<Kernel>{.kernel = kernel, .place = place, .first = first, .list = list});
  for_each_item(queue, rows, SortRow<Kernel>{kernel, first, list});
}

template <class Kernel>
void list_rows(Queue queue, Index items, Index numbers, Index rows, const Kernel& kernel,
               Column<Index>& first, Column<Index>& list) {
  const Index* const place = count_in_rows(queue, items, numbers, rows, kernel, first);
  list.renew(scan(queue, rows, first.data() + 1, first.data()));
  put_in_rows(queue, items, rows, kernel, place, first.data(), list.data());
}
template <class Kernel>
void list_rows_in_room(Queue queue, Index items, Index numbers, Index rows, const Kernel& kernel,
                       Column<Index>& first, Column<Index>& list) {
  const Index* const place = count_in_rows(queue, items, numbers, rows, kernel, first);
  add_up(queue, rows, first.data() + 1, first.data());
  list.renew(numbers);
  put_in_rows(queue, items, rows, kernel, place, first.data(), list.data());
}

}  // namespace cdem
