// primitives.cpp - bodies of primitives.hpp. Compiled as C++ for the CPU, and as CUDA.
#include "core/base/primitive_loops.hpp"

#if defined(CDEM_CUDA)
#include <thrust/iterator/counting_iterator.h>

#include <cub/cub.cuh>
#endif

namespace cdem {

template void set_all(Queue, Index, Flag*, Flag);
template void set_all(Queue, Index, Index*, Index);
template void set_all(Queue, Index, Real*, Real);
template void copy_items(Queue, Index, const Flag*, Flag*);
template void copy_items(Queue, Index, const Real*, Real*);
template void select_items(Queue, Index, const IsSet&, Column<Index>&);
template Real exact_sum(Queue, Index, const EachNumber<>&, const Counted&);
template Real exact_sum(Queue, Index, const EachNumber<4>&, const Counted&);

namespace {

struct TellSum {
  const Index* sum;
  Index* answer;
  CDEM_HD void operator()(One) const { *answer = *sum; }
};

}  // namespace

void add_up(Queue queue, Index count, const Index* counts, Index* first, Answer<Index>& sum) {
  add_up(queue, count, counts, first);
  for_each_item(queue, 1, TellSum{first + count, sum.data()});
}

Real column_sum(Queue queue, const Column<Real>& column, const Counted& counted) {
  return exact_sum(queue, Index(column.size()), EachNumber<>{column.data()}, counted);
}

#if defined(CDEM_CUDA)

namespace {

cudaStream_t stream_of(Queue queue) { return static_cast<cudaStream_t>(queue.stream); }

/// Call run(memory, bytes), a function of CUB with the memory that it asks for.
template <class Run>
void with_memory(const Run& run) {
  std::size_t bytes = 0;
  check(run(nullptr, bytes));
  check(run(scratch<char>(bytes + 1), bytes));  // never null, which would ask again
}

/// A word copied to the host once all launched kernels have finished.
template <class T>
T fetch_word(Queue queue, const T* word) {
  T value;
  check(cudaMemcpyAsync(&value, word, sizeof value, cudaMemcpyDefault, stream_of(queue)));
  finish(queue);
  return value;
}

/// Of two items the one with the larger number, the first where they have the same.
struct Larger {
  const Real* values;
  CDEM_HD Index operator()(Index a, Index b) const {
    Most most;
    if (a >= 0) most.meet(values[a], a);
    if (b >= 0) most.meet(values[b], b);
    return most.item;
  }
};
struct TellMost {
  const Real* values;
  const Index* item;
  Most* answer;
  CDEM_HD void operator()(One) const {
    Most most;
    if (*item >= 0) most.meet(values[*item], *item);
    *answer = most;
  }
};

}  // namespace

void add_up(Queue queue, Index count, const Index* counts, Index* first) {
  check(cudaMemsetAsync(first, 0, sizeof *first, stream_of(queue)));
  with_memory([&](void* memory, std::size_t& bytes) {
    return cub::DeviceScan::InclusiveSum(memory, bytes, counts, first + 1, count, stream_of(queue));
  });
}
Index scan(Queue queue, Index count, const Index* counts, Index* first) {
  add_up(queue, count, counts, first);
  return fetch_word(queue, first + count);
}

void find_most_of(Queue queue, Index count, const Real* values, Most* answer) {
  Index* const item = scratch<Index>(1);
  with_memory([&](void* memory, std::size_t& bytes) {
    return cub::DeviceReduce::Reduce(memory, bytes, thrust::counting_iterator<Index>(0), item,
                                     count, Larger{values}, Index(-1), stream_of(queue));
  });
  for_each_item(queue, 1, TellMost{values, item, answer});
}

std::int64_t* zeroed_words(Queue queue) {
  std::int64_t* const words = scratch<std::int64_t>(ExactSum::words);
  check(cudaMemsetAsync(words, 0, ExactSum::words * sizeof *words, stream_of(queue)));
  return words;
}
Real sum_of_words(Queue queue, const std::int64_t* words, Exchange* ranks) {
  std::int64_t here[ExactSum::words];
  check(cudaMemcpyAsync(here, words, sizeof here, cudaMemcpyDefault, stream_of(queue)));
  finish(queue);
  ExactSum sum;
  sum.add(here);
  sum.add_ranks(ranks);
  return sum.value();
}

void sort_pairs(Queue queue, Index count, std::uint64_t* keys, Index* values) {
  std::uint64_t* const sorted_keys = scratch<std::uint64_t>(count);
  Index* const sorted_values = scratch<Index>(count);
  with_memory([&](void* memory, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(memory, bytes, keys, sorted_keys, values, sorted_values,
                                           count, 0, 64, stream_of(queue));
  });
  const auto take = [&](auto* to, const auto* from) {
    check(cudaMemcpyAsync(to, from, count * sizeof *from, cudaMemcpyDefault, stream_of(queue)));
  };
  take(keys, sorted_keys);
  take(values, sorted_values);
}

#else

#if defined(CDEM_EMULATED)

namespace {

// One item that does all: where its memory lies is checked; the order of items is CUB's affair.
struct Scan {
  Index count;
  const Index* counts;
  Index* first;
  void operator()(One) const {
    Index sum = first[0] = 0;
    for (Index i = 0; i < count; ++i) first[i + 1] = sum += counts[i];
  }
};
struct FindMost {
  Index count;
  const Real* values;
  Most* most;
  void operator()(One) const {
    *most = {};
    for (Index i = 0; i < count; ++i) most->meet(values[i], i);
  }
};
struct AddUp {
  Index count;
  const Real* values;
  std::int64_t* words;
  void operator()(One) const {
    for (int k = 0; k < ExactSum::words; ++k) words[k] = 0;
    for (Index i = 0; i < count; ++i) NumberDigits(values[i]).add_to(words);
  }
};

/// Runs of pairs are merged to runs of twice the length, from one array to the other and back.
struct SortPairs {
  Index count;
  std::uint64_t *keys, *other_keys;
  Index *values, *other_values;
  void operator()(One) const {
    SortPairs from = *this;
    for (Index run = 1; run<count; run = count - run> run ? 2 * run : count) {
      for (Index first = 0; first < count; first += std::min(2 * run, count - first))
        from.merge(first, std::min(run, count - first), std::min(2 * run, count - first));
      from = {.count = count,
              .keys = from.other_keys,
              .other_keys = from.keys,
              .values = from.other_values,
              .other_values = from.values};
    }
    for (Index i = 0; from.keys != keys && i < count; ++i) {
      keys[i] = from.keys[i];
      values[i] = from.values[i];
    }
  }

 private:
  void merge(Index first, Index middle, Index last) const {
    Index a = first, b = first + middle;
    for (Index i = first; i < first + last; ++i) {
      const bool takes_a = a < first + middle && (b == first + last || keys[a] <= keys[b]);
      const Index from = takes_a ? a++ : b++;
      other_keys[i] = keys[from];
      other_values[i] = values[from];
    }
  }
};

template <class T>
T fetch_word(const T* word) {
  finish({});
  const Transfer transfer;
  return *word;
}

}  // namespace

void add_up(Queue queue, Index count, const Index* counts, Index* first) {
  for_each_item(queue, 1, Scan{count, counts, first});
}
Index scan(Queue queue, Index count, const Index* counts, Index* first) {
  add_up(queue, count, counts, first);
  return fetch_word(first + count);
}

void find_most_of(Queue queue, Index count, const Real* values, Most* answer) {
  for_each_item(queue, 1, FindMost{count, values, answer});
}

void sort_pairs(Queue queue, Index count, std::uint64_t* keys, Index* values) {
  for_each_item(queue, 1,
                SortPairs{.count = count,
                          .keys = keys,
                          .other_keys = scratch<std::uint64_t>(count),
                          .values = values,
                          .other_values = scratch<Index>(count)});
}

Real exact_sum_of(Queue queue, Index count, const Real* values, Exchange* ranks) {
  std::int64_t* const words = scratch<std::int64_t>(ExactSum::words);
  for_each_item(queue, 1, AddUp{count, values, words});
  finish(queue);
  const Transfer transfer;
  ExactSum sum;
  sum.add(words);
  sum.add_ranks(ranks);
  return sum.value();
}

#else

Index scan(Queue, Index count, const Index* counts, Index* first) {
  const Parts parts = parts_of(count, 64 * worth_threads);  // little work an item
  std::vector<Index> before(parts.count + 1);
  if (parts.count > 1)
    parts.for_each([&](Index p, Range part) {
      for (Index i = part.first; i < part.last; ++i) before[p + 1] += counts[i];
    });
  for (Index p = 0; p < parts.count; ++p) before[p + 1] += before[p];
  first[0] = 0;
  parts.for_each([&](Index p, Range part) {
    Index sum = before[p];
    for (Index i = part.first; i < part.last; ++i) first[i + 1] = sum += counts[i];
  });
  return first[count];
}
void add_up(Queue queue, Index count, const Index* counts, Index* first) {
  scan(queue, count, counts, first);
}

/// Byte after byte from the lowest one, by as many counts as there are values of a byte and parts.
void sort_pairs(Queue, Index count, std::uint64_t* keys, Index* values) {
  constexpr Index digits = 256;
  const Parts parts = parts_of(count, 16 * worth_threads);
  std::vector<Index> place(digits * std::size_t(parts.count));
  std::vector<std::uint64_t> other_keys(count);
  std::vector<Index> other_values(count);
  std::uint64_t* to_keys = other_keys.data();
  Index* to_values = other_values.data();
  for (int shift = 0; shift < 64; shift += 8) {
    const auto place_of = [&](Index part, std::uint64_t key) -> Index& {
      return place[(key >> shift) % digits * parts.count + part];
    };
    std::fill(place.begin(), place.end(), 0);
    parts.for_each([&](Index p, Range part) {
      for (Index i = part.first; i < part.last; ++i) ++place_of(p, keys[i]);
    });
    for (Index next = 0; Index & here : place) next += std::exchange(here, next);
    parts.for_each([&](Index p, Range part) {
      for (Index i = part.first; i < part.last; ++i) {
        const Index to = place_of(p, keys[i])++;
        to_keys[to] = keys[i];
        to_values[to] = values[i];
      }
    });
    std::swap(keys, to_keys);
    std::swap(values, to_values);
  }  // an even number of times: the given array is sorted
}

#endif

#endif

}  // namespace cdem
