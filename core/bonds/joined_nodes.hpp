// joined_nodes.hpp - kernels that label nodes by the lowest one of those that pairs join.
#pragma once

#include <cstdint>

#include "core/base/parallel.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

/// Labels of nodes, which several threads lower at once.
///
/// The label of a node is one that it is joined to, and not a higher one. Whatever label it had,
/// lower labels lead from there to the lowest node so far, so threads may lower labels in any
/// order, and none waits for another: what all joins end with depends on the pairs alone.
struct Labels {
  Index* label;
  bool alone;  // see lower_to

  /// The lowest node so far. It becomes nearer for those on the way.
  CDEM_HD Index lowest(Index node) const {
    for (;;) {
      const Index next = peek(label[node]), beyond = peek(label[next]);
      if (next == beyond) return next;
      lower_to(label[node], beyond, alone);
      node = beyond;
    }
  }
  CDEM_HD void join(Index a, Index b) const {
    for (;;) {
      a = lowest(a), b = lowest(b);
      if (a == b) return;
      const Index low = a < b ? a : b, high = a < b ? b : a;
      const Index before = lower_to(label[high], low, alone);
      if (before == high) return;
      a = before, b = low;  // another thread had joined it to this one, which must not be lost
    }
  }
};

/// Nodes begin with labels of their own, or with the first node of their block.
struct StartLabels {
  const Index* block_first;  // or null
  Index* label;
  CDEM_HD void operator()(One node) const {
    label[node.i] = block_first ? block_first[node.i] : node.i;
  }
};

/// Join the nodes of intact points of live conforming pairs.
struct JoinBondedNodes {
  const Flag* status;
  const Real* bond;                     // [point][pair]
  const Index* nodes;                   // [2 * points][pair]
  Index points, stride, stride_points;  // of a pair; of the tables of nodes and of points
  Labels labels;

  CDEM_HD void operator()(One pair) const {
    if (!is_live(PairStatus(status[pair.i]))) return;
    for (Index k = 0; k < points; ++k)
      if (bond[std::size_t(k) * stride_points + pair.i] > 0)
        labels.join(nodes[std::size_t(k) * stride + pair.i],
                    nodes[std::size_t(points + k) * stride + pair.i]);
  }
};

/// Join the blocks of live pairs.
struct JoinBodies {
  const Flag* status;
  const Index *faces, *face_nodes;  // [pair][2], [face][4]
  Labels labels;

  CDEM_HD void operator()(One pair) const {
    if (is_live(PairStatus(status[pair.i]))) labels.join(node_of(pair, 0), node_of(pair, 1));
  }

 private:
  CDEM_HD Index node_of(One pair, Index side) const {
    return face_nodes[4 * std::size_t(faces[2 * std::size_t(pair.i) + side])];
  }
};

/// After all joins every label becomes the lowest.
struct FinishLabels {
  Labels labels;
  CDEM_HD void operator()(One node) const {
    lower_to(labels.label[node.i], labels.lowest(node.i), labels.alone);
  }
};

// Of ranks, see join_labels_of_ranks.

/// Nodes begin with their numbers in the whole model.
struct NumberOfNode {
  const Index* number;
  Real* told;
  CDEM_HD void operator()(One node) const { told[node.i] = number[node.i]; }
};
/// A label meets the numbers that its nodes are told.
struct LowerLabels {
  Labels labels;
  const Real* told;
  Real* lowest;  // [label]
  CDEM_HD void operator()(One node) const {
    lower_to(lowest[labels.label[node.i]], told[node.i], labels.alone);
  }
};
/// Is a node told of a lower number than its label has met?
struct IsToldLower {
  const Index* label;
  const Real *lowest, *told;
  CDEM_HD bool operator()(One node) const { return told[node.i] < lowest[label[node.i]]; }
};
struct TellLowest {
  const Index* label;
  const Real* lowest;
  Real* told;
  CDEM_HD void operator()(One node) const { told[node.i] = lowest[label[node.i]]; }
};
/// Keys that bring nodes with one number together, ascending.
struct KeysOfLowest {
  const Real* told;
  std::uint64_t* keys;
  Index* nodes;
  CDEM_HD void operator()(One node) const {
    keys[node.i] = std::uint64_t(told[node.i]);
    nodes[node.i] = node.i;
  }
};
struct JoinSameKeys {
  const std::uint64_t* keys;
  const Index* nodes;
  Labels labels;
  CDEM_HD void operator()(One place) const {
    if (keys[place.i] == keys[place.i + 1]) labels.join(nodes[place.i], nodes[place.i + 1]);
  }
};

}  // namespace cdem
