// supports.hpp - components of nodes whose velocity is given.
#pragma once

#include "core/base/math.hpp"

namespace cdem {

/// Supports: components of a node whose velocity is given (zero for a fixed one).
struct SupportColumns {
  const Index* support;        // [node]: row below, or -1
  const Flag* component;       // [support][3]: 1 where the velocity is given
  const Index* curve;          // [support][3]: curve that scales it
  const Real* velocity;        // [support][3]  [m/s]
  const Real* curve_velocity;  // [curve] factors at the middle of the coming step

  CDEM_HD bool given(Index node, Index axis) const {
    return support[node] >= 0 && component[3 * support[node] + axis];
  }
  CDEM_HD Real at(Index node, Index axis) const {
    const Index row = 3 * support[node] + axis;
    return velocity[row] * curve_velocity[curve[row]];
  }
  /// A row of the node with the given components put in, or with zeros in their places.
  CDEM_HD Row with_given(Index node, const Row& free) const {
    if (support[node] < 0) return free;
    const auto part = [&](Index axis) { return given(node, axis) ? at(node, axis) : free.n[axis]; };
    return Row::of(part(0), part(1), part(2));
  }
  CDEM_HD Row without_given(Index node, const Row& row) const {
    if (support[node] < 0) return row;
    const auto part = [&](Index axis) { return given(node, axis) ? 0.0 : row.n[axis]; };
    return Row::of(part(0), part(1), part(2));
  }
};

}  // namespace cdem
