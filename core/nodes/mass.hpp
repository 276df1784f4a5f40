// mass.hpp - masses of nodes: a number each, or the consistent mass matrix of a small block.
#pragma once

#include "core/base/views.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// Mass of the nodes: a number each, or for small blocks the inverse of the consistent mass matrix,
/// which gives them their exact inertia. Matrices are kept without the mass, so that all tets share
/// one.
struct MassColumns {
  bool lumped;                    // only the numbers count, whatever the matrices
  const Flag* node_lumped;        // [node] 1: for this node only the number counts; null: for none
  const Real* mass;               // [node] row sum of the mass matrix  [kg]
  const Index* mass_row_first;    // [node]: start of the node's row in `inverse`, or -1 when lumped
  const Index* mass_axis_stride;  // [node]: from one axis to the next (0 when all three share)
  const Index* block_first;       // [node]: first node of the block
  const Index* block_count;       // [node]: nodes of the block
  const Real* inverse;            // rows of the inverse times `mass`, supported nodes taken out
  const Real* matrix;             // rows of the matrix over `mass`, in the same places

  /// Start of a node's row in `inverse` and `matrix`, or -1 when its mass is lumped.
  CDEM_HD Index row(Index node) const { return is_lumped(node) ? -1 : mass_row_first[node]; }
  /// Does only the number count at a node, whether or not its block has a matrix?
  CDEM_HD bool is_lumped(Index node) const { return lumped || (node_lumped && node_lumped[node]); }
  /// Is a node of the block supported, so that the inverse differs from axis to axis?
  CDEM_HD bool held(Index node) const { return row(node) >= 0 && mass_axis_stride[node] > 0; }
  /// Part of M a of a node that the given motion of supported nodes of its block makes, row by row
  /// of the full matrix  [N].
  CDEM_HD Row given_inertia(const SupportColumns& supports, const InMotion& nodes, Index i,
                            Real kick) const {
    Vec3<Real> sum{0.0, 0.0, 0.0};
    const Index start = row(i);
    for (Index j = 0; j < block_count[i]; ++j) {
      const Index other = block_first[i] + j;
      if (supports.support[other] < 0) continue;
      const Real m = mass[i] * matrix[start + j] / kick;
      const Vec3<Real> v = nodes.velocity(other);
      if (supports.given(other, 0)) sum.x += m * (supports.at(other, 0) - v.x);
      if (supports.given(other, 1)) sum.y += m * (supports.at(other, 1) - v.y);
      if (supports.given(other, 2)) sum.z += m * (supports.at(other, 2) - v.z);
    }
    return Row::of(sum.x, sum.y, sum.z);
  }
  /// Momentum M v of a node  [kg m/s].
  CDEM_HD Row momentum(const InMotion& nodes, Index i) const {
    const Index start = row(i);
    if (start < 0) return mass[i] * nodes.velocity_row(i);
    Row p = Row::zero();
    for (Index j = 0; j < block_count[i]; ++j)
      p = p + matrix[start + j] * nodes.velocity_row(block_first[i] + j);
    return mass[i] * p;
  }
};

}  // namespace cdem
