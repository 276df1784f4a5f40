// exact_sum.hpp - sums that have the same bits whatever the order of their terms.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/column.hpp"
#include "core/base/parallel.hpp"

namespace cdem {

/// A sum of numbers without round-off: digits of 32 bits, from the smallest number to 2^973, as
/// integers. These add up to the same in any order, so a sum may be made of parts.
class ExactSum {
 public:
  static constexpr Index most = 1024;  // numbers at a time

  /// Add numbers, which are lost; behind them there is room up to `most`. For all parts of a sum
  /// together up to 2^31.
  void add(Real* numbers, Index count);
  void add(const ExactSum& part);
  /// Within two units in the last place; no number if one of them was none or too large.
  Real value() const;

 private:
  static constexpr int digits = 64;
  std::array<std::int64_t, digits> digit_{};
  bool finite_ = true;
};

/// Sum of `term(i)`, which is called once for each of `count` items.
template <class Term>
Real exact_sum(Index count, Term&& term) {
  constexpr Index chunk = ExactSum::most;
  ExactSum all;
#pragma omp parallel if (count >= worth_threads)
  {
    ExactSum own;
    alignas(64) Real numbers[chunk];
#pragma omp for schedule(static) nowait
    for (Index c = 0; c < count / chunk + (count % chunk > 0); ++c) {
      const Index first = c * chunk, here = std::min(chunk, count - first);
      for (Index i = 0; i < here; ++i) numbers[i] = term(first + i);
      own.add(numbers, here);
    }
#pragma omp critical(cdem_exact_sum)
    all.add(own);
  }
  return all.value();
}

/// Sum of a column.
inline Real column_sum(const Column<Real>& c) {
  const auto numbers = on_host(c);
  return exact_sum(Index(c.size()), [&](Index i) { return numbers[i]; });
}

}  // namespace cdem
