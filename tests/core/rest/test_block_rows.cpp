// Sparse matrices of blocks: products and transposes agree with those of dense matrices.
#include <vector>

#include "core/rest/block_rows.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// A matrix of which a third of the blocks are there, and the same one dense.
struct Sparse {
  BlockRows blocks;
  std::vector<Real> dense;
  Index rows, columns;

  Sparse(Random& random, Index block_rows, Index block_columns, Index height, Index width)
      : rows(block_rows * height), columns(block_columns * width) {
    blocks.height = height, blocks.width = width, blocks.columns = block_columns;
    dense.resize(std::size_t(rows) * columns);
    std::vector<Index> first{0}, column;
    std::vector<Real> block;
    for (Index r = 0; r < block_rows; ++r) {
      for (Index c = 0; c < block_columns; ++c) {
        if (random.below(3) > 0) continue;
        column.push_back(c);
        for (Index k = 0; k < height * width; ++k) {
          block.push_back(random.between(-1, 1));
          dense[std::size_t(r * height + k / width) * columns + c * width + k % width] =
              block.back();
        }
      }
      first.push_back(Index(column.size()));
    }
    blocks.first.assign(first);
    blocks.column.assign(column);
    blocks.block.assign(block);
  }
  Real at(Index r, Index c) const { return dense[std::size_t(r) * columns + c]; }
};

Real entry(const BlockRows& a, Index r, Index c) {
  const auto first = on_host(a.first), column = on_host(a.column);
  const auto block = on_host(a.block);
  for (Index e = first[r / a.height]; e < first[r / a.height + 1]; ++e)
    if (column[e] == c / a.width)
      return block[std::size_t(e) * a.height * a.width + r % a.height * a.width + c % a.width];
  return 0;
}

Column<Real> numbers(Random& random, Index count) {
  Column<Real> x;
  x.resize(count);
  for (Real& one : on_host(x)) one = random.between(-1, 1);
  return x;
}

}  // namespace

TEST_CASE("products with vectors") {
  Random random(1);
  for (const auto& [height, width] : {std::pair{3, 3}, {3, 6}, {6, 3}, {6, 6}}) {
    const Sparse a(random, 7, 5, height, width);
    const Column<Real> x = numbers(random, a.columns), b = numbers(random, a.rows);
    Column<Real> y = numbers(random, a.rows), sum, rest;
    sum.assign(fetch(y));
    rest.resize(a.rows);
    residual({}, a.blocks, b.data(), x.data(), rest.data());
    multiply_add({}, a.blocks, x.data(), sum.data());
    const std::vector<Real> before = fetch(y);
    multiply({}, a.blocks, x.data(), y.data());
    const auto at_x = on_host(x), at_b = on_host(b);
    for (Index r = 0; r < a.rows; ++r) {
      Real exact = 0;
      for (Index c = 0; c < a.columns; ++c) exact += a.at(r, c) * at_x[c];
      CHECK(on_host(y)[r] == doctest::Approx(exact).epsilon(1e-13));
      CHECK(on_host(sum)[r] == doctest::Approx(before[r] + exact).epsilon(1e-13));
      CHECK(on_host(rest)[r] == doctest::Approx(at_b[r] - exact).epsilon(1e-13));
    }
  }
}

TEST_CASE("the transpose, and a product of two matrices") {
  Random random(2);
  const Sparse a(random, 6, 9, 3, 6), b(random, 9, 4, 6, 3);
  const BlockRows turned = transposed(a.blocks), both = product(a.blocks, b.blocks);
  for (Index r = 0; r < a.rows; ++r)
    for (Index c = 0; c < a.columns; ++c) CHECK(entry(turned, c, r) == a.at(r, c));
  for (Index r = 0; r < a.rows; ++r)
    for (Index c = 0; c < b.columns; ++c) {
      Real exact = 0;
      for (Index k = 0; k < a.columns; ++k) exact += a.at(r, k) * b.at(k, c);
      CHECK(entry(both, r, c) == doctest::Approx(exact).epsilon(1e-13));
    }
}

}  // namespace cdem::test
