// reduce.hpp - sums in a fixed order, whatever the number of threads.
#pragma once

#include <vector>

#include "core/base/column.hpp"
#include "core/base/parallel.hpp"

namespace cdem {

/// Sum in a fixed order whatever the number of threads: fixed chunks, then the chunks in order.
template <class Term>
Real ordered_sum(Index count, Term&& term) {
  constexpr Index chunk = 1024;
  const Index chunks = (count + chunk - 1) / chunk;
  std::vector<Real> part(chunks);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index c = 0; c < chunks; ++c) {
    Real sum = 0;
    const Index last = c + 1 == chunks ? count : (c + 1) * chunk;
    for (Index i = c * chunk; i < last; ++i) sum += term(i);
    part[c] = sum;
  }
  Real sum = 0;
  for (const Real p : part) sum += p;
  return sum;
}

/// Sum of a column, in the same fixed order.
inline Real column_sum(const Column<Real>& c) {
  return ordered_sum(Index(c.size()), [&](Index i) { return c[i]; });
}

}  // namespace cdem
