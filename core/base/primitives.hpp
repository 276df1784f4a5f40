// primitives.hpp - operations on whole arrays: set, add up, find the most, select, sort, bring
// into rows.
//
// Integers and comparisons alone, so every device and every number of threads give the same. The
// bodies of templates are in primitive_loops.hpp and are instantiated in core/kernels, where the
// other bodies are, too.
#pragma once

#include <cstdint>

#include "core/base/answer.hpp"
#include "core/base/any_item.hpp"
#include "core/base/column.hpp"
#include "core/base/exchange.hpp"
#include "core/base/parallel.hpp"

namespace cdem {

/// Set `count` items to a value. T is Flag, Index or Real.
template <class T>
void set_all(Queue queue, Index count, T* items, T value);

/// Copy `count` items.
template <class T>
void copy_items(Queue queue, Index count, const T* from, T* into);

/// Starts of rows: first[i] becomes the sum of the counts before row i, first[count] the sum of
/// all. `counts` may be first + 1.
void add_up(Queue queue, Index count, const Index* counts, Index* first);
/// The same, with the sum of all where the host can read it.
void add_up(Queue queue, Index count, const Index* counts, Index* first, Answer<Index>& sum);
/// The same. Waits for the sum, which is returned.
Index scan(Queue queue, Index count, const Index* counts, Index* first);

/// The largest of some numbers, and the first item that has it.
struct Most {
  Real value = -infinity;
  Index item = -1;  // where there is no number above -infinity

  CDEM_HD void meet(Real other, Index of) {
    if (!(other > value || (other == value && of < item))) return;
    value = other;
    item = of;
  }
};

/// Find the largest `kernel(item)` of the own items of a rank, or of all (null), where kernels can
/// read it; NaN does not count.
template <class Kernel>
void find_most(Queue queue, Index count, const Kernel& kernel, const Flag* own,
               Answer<Most>& answer);
/// The same. Waits for the answer.
template <class Kernel>
Most most(Queue queue, Index count, const Kernel& kernel, const Flag* own);

/// Sum of `kernel(item)`, which is called once for each item, without round-off: see exact_sum.hpp.
/// Items that count for another rank add what they have there. Waits for it.
template <class Kernel>
Real exact_sum(Queue queue, Index count, const Kernel& kernel, const Counted& counted);

/// A number of every item, for a sum of it: of rows that are `stride` long.
template <Index stride = 1>
struct EachNumber {
  const Real* first;
  CDEM_HD Real operator()(One item) const { return first[std::size_t(item.i) * stride]; }
};
/// Sum of an array.
Real column_sum(Queue queue, const Column<Real>& column, const Counted& counted);

/// Is the flag of an item set?
struct IsSet {
  const Flag* flags;
  CDEM_HD bool operator()(One item) const { return flags[item.i] != 0; }
};

/// List the items for which `kernel(item)` holds, ascending. Waits for how many they are.
template <class Kernel>
void select_items(Queue queue, Index count, const Kernel& kernel, Column<Index>& list);

/// List the items of rows, row after row: `kernel.visit(row, act)` calls act(item) for those of a
/// row, the same ones whenever it is called. Waits for how many they are.
template <class Item, class Kernel>
void list_items(Queue queue, Index rows, const Kernel& kernel, Column<Item>& items);
/// The same with the starts of the rows: those of a row are from first[row] to before
/// first[row + 1].
template <class Item, class Kernel>
void list_items(Queue queue, Index rows, const Kernel& kernel, Column<Index>& first,
                Column<Item>& items);

/// Keep the items of a list for which `kernel(item)` holds, in order; it may change an item. Waits
/// for how many they are.
template <class Item, class Kernel>
void keep_items(Queue queue, const Kernel& kernel, Column<Item>& items);

/// Sort pairs by their keys; pairs of one key stay in order.
void sort_pairs(Queue queue, Index count, std::uint64_t* keys, Index* values);

/// Bring numbers into rows, in each in the order of `kernel.is_before(one, other)`, or ascending
/// where it has none: `kernel.visit(item, act)` calls act(row, number) for
/// the numbers of an item, which are below `numbers`, each once. The numbers of a row are in the
/// list from first[row] on, before first[row + 1]. Waits for their count.
template <class Kernel>
void list_rows(Queue queue, Index items, Index numbers, Index rows, const Kernel& kernel,
               Column<Index>& first, Column<Index>& list);
/// The same without a wait: the list has room for all `numbers`. Where rows do not have each of
/// them, its last ones are not set.
template <class Kernel>
void list_rows_in_room(Queue queue, Index items, Index numbers, Index rows, const Kernel& kernel,
                       Column<Index>& first, Column<Index>& list);

}  // namespace cdem
