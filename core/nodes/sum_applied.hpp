// sum_applied.hpp - the sum of the applied forces of a module on each node, and its work.
#pragma once

#include "core/base/views.hpp"

namespace cdem {

/// Sum rows on each node in a fixed order, and their work: by the mean of the forces before
/// and after a step over its displacement.
struct SumApplied {
  InMotion nodes;
  const Index* first;  // [node + 1]
  const Index* row;
  InForces rows;
  const Flag* out;  // [node] 1: taken out; null: none is
  Real dt;          // of the last step  [s]
  Real* force;      // row of 4  [N]
  Real* work;       // [node]  [J]

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    if (first[i] == first[i + 1]) return;
    Row sum = Row::zero();
    for (Index c = first[i]; c < first[i + 1] && !(out && out[i]); ++c) sum = sum + rows.at(row[c]);
    Real* own = force + std::size_t(i) * 4;
    const Row mean = 0.5 * (Row::at(own) + sum);
    work[i] += dt * dot(mean.vector(), nodes.velocity(i));
    sum.store(own);
  }
};

/// Add the forces of several modules on a node, in their order.
struct AddApplied {
  const Real* force;  // of one module, row of 4  [N]
  bool first;         // is it the first of them?
  Real* sum;          // row of 4  [N]

  CDEM_HD void operator()(One node) const {
    const std::size_t at = std::size_t(node.i) * 4;
    const Row own = Row::at(force + at);
    (first ? own : Row::at(sum + at) + own).store(sum + at);
  }
};

}  // namespace cdem
