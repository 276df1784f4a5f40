// block_rows.cpp - see block_rows.hpp.
#include "core/rest/block_rows.hpp"

#include <algorithm>

#include "core/rest/products.hpp"

namespace cdem {

namespace {

template <Index height, Index width, Into into>
void launch_rows(Queue q, const BlockRows& a, const Real* x, const Real* b, Real* y) {
  for_each_item(q, a.rows(),
                MultiplyRow<height, width, into>{.first = a.first.data(),
                                                 .column = a.column.data(),
                                                 .block = a.block.data(),
                                                 .x = x,
                                                 .b = b,
                                                 .y = y});
}

template <Into into>
void launch_product(Queue q, const BlockRows& a, const Real* x, const Real* b, Real* y) {
  if (a.height == 3 && a.width == 3) launch_rows<3, 3, into>(q, a, x, b, y);
  if (a.height == 3 && a.width == 6) launch_rows<3, 6, into>(q, a, x, b, y);
  if (a.height == 6 && a.width == 3) launch_rows<6, 3, into>(q, a, x, b, y);
  if (a.height == 6 && a.width == 6) launch_rows<6, 6, into>(q, a, x, b, y);
}

}  // namespace

void multiply(Queue q, const BlockRows& a, const Real* x, Real* y) {
  launch_product<Into::replace>(q, a, x, nullptr, y);
}

void multiply_add(Queue q, const BlockRows& a, const Real* x, Real* y) {
  launch_product<Into::add>(q, a, x, nullptr, y);
}

void residual(Queue q, const BlockRows& a, const Real* b, const Real* x, Real* y) {
  launch_product<Into::take_from>(q, a, x, b, y);
}

BlockRows transposed(const BlockRows& a) {
  const auto first = on_host(a.first), column = on_host(a.column);
  const auto block = on_host(a.block);
  const Index entries = Index(column.size()), size = a.block_size_of();
  BlockRows t{.height = a.width, .width = a.height, .columns = a.rows()};
  std::vector<Index> start(a.columns + 1), other(entries);
  std::vector<Real> turned(block.size());
  for (Index e = 0; e < entries; ++e) ++start[column[e] + 1];
  for (Index r = 0; r < a.columns; ++r) start[r + 1] += start[r];
  std::vector<Index> next(start.begin(), start.end() - 1);
  for (Index r = 0; r < a.rows(); ++r)
    for (Index e = first[r]; e < first[r + 1]; ++e) {
      const Index place = next[column[e]]++;
      other[place] = r;
      for (Index i = 0; i < a.height; ++i)
        for (Index j = 0; j < a.width; ++j)
          turned[std::size_t(place) * size + j * a.height + i] =
              block[std::size_t(e) * size + i * a.width + j];
    }
  t.first.assign(start);
  t.column.assign(other);
  t.block.assign(turned);
  return t;
}

namespace {

/// The columns of a row of A B, ascending.
class RowColumns {
 public:
  explicit RowColumns(Index columns) : place_(columns, -1) {}

  void add(Index column) {
    if (place_[column] >= 0) return;
    place_[column] = 0;
    list_.push_back(column);
  }
  /// Sort them, and number them from `start`.
  const std::vector<Index>& sorted(Index start) {
    std::sort(list_.begin(), list_.end());
    for (std::size_t k = 0; k < list_.size(); ++k) place_[list_[k]] = start + Index(k);
    return list_;
  }
  Index place(Index column) const { return place_[column]; }
  void clear() {
    for (const Index column : list_) place_[column] = -1;
    list_.clear();
  }

 private:
  std::vector<Index> place_, list_;
};

/// c += a b of dense blocks
void add_product(Index height, Index inner, Index width, const Real* a, const Real* b, Real* c) {
  for (Index i = 0; i < height; ++i)
    for (Index k = 0; k < inner; ++k)
      for (Index j = 0; j < width; ++j) c[i * width + j] += a[i * inner + k] * b[k * width + j];
}

}  // namespace

BlockRows product(const BlockRows& a, const BlockRows& b) {
  const auto a_first = on_host(a.first), a_column = on_host(a.column);
  const auto b_first = on_host(b.first), b_column = on_host(b.column);
  const auto a_block = on_host(a.block), b_block = on_host(b.block);
  BlockRows c{.height = a.height, .width = b.width, .columns = b.columns};
  const std::size_t size = c.block_size_of();
  std::vector<Index> first{0}, column;
  std::vector<Real> block;
  RowColumns row(b.columns);
  for (Index r = 0; r < a.rows(); ++r) {
    for (Index e = a_first[r]; e < a_first[r + 1]; ++e)
      for (Index f = b_first[a_column[e]]; f < b_first[a_column[e] + 1]; ++f) row.add(b_column[f]);
    const std::vector<Index>& found = row.sorted(first.back());
    column.insert(column.end(), found.begin(), found.end());
    block.resize(column.size() * size);
    for (Index e = a_first[r]; e < a_first[r + 1]; ++e)
      for (Index f = b_first[a_column[e]]; f < b_first[a_column[e] + 1]; ++f)
        add_product(a.height, a.width, b.width, &a_block[std::size_t(e) * a.block_size_of()],
                    &b_block[std::size_t(f) * b.block_size_of()],
                    &block[row.place(b_column[f]) * size]);
    row.clear();
    first.push_back(Index(column.size()));
  }
  c.first.assign(first);
  c.column.assign(column);
  c.block.assign(block);
  return c;
}

}  // namespace cdem
