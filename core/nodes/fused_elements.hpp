// fused_elements.hpp - kernels that find the blocks of elements which the fused kernel moves.
#pragma once

#include "core/base/parallel.hpp"
#include "core/nodes/mass.hpp"
#include "core/nodes/ports.hpp"

namespace cdem {

/// What moves a block of `block_size` elements of one shape.
enum class MovedBy : Flag { none, fused, fused_lumped, general };

CDEM_HD inline bool is_fused(MovedBy by) {
  return by == MovedBy::fused || by == MovedBy::fused_lumped;
}

/// Elements of one shape, with what acts on their nodes.
struct FusedElements {
  Index count, corners;
  InIndices nodes;
  const Index *support, *block_first, *block_count;
  MassColumns mass;
  NodePorts ports;

  CDEM_HD Index first_node(Index i) const { return nodes.at(0, i); }
  /// The rows that a node sums after the rows of its element.
  CDEM_HD Range bond_rows(Index node) const {
    return {ports.corners.first[node], ports.corners.first[node + 1]};
  }
  CDEM_HD bool is_lumped(Index i) const { return mass.row(first_node(i)) < 0; }
  CDEM_HD bool is_fused(Index i) const {
    const Index first = first_node(i), row = mass.row(first);
    if (block_first[first] != first || block_count[first] != corners) return false;
    for (Index k = 0; k < corners; ++k) {
      const Index node = first + k;
      if (nodes.at(k, i) != node || !ports.is_plain(node) || support[node] >= 0 ||
          mass.row(node) != (row < 0 ? row : row + corners * k) || mass.held(node))
        return false;
    }
    return true;
  }
  /// Are all elements of a block fused, with masses of one kind?
  CDEM_HD MovedBy moved_by(Index block) const {
    const Range all = elements(block);
    for (Index i = all.first; i < all.last; ++i)
      if (!is_fused(i) || is_lumped(i) != is_lumped(all.first)) return MovedBy::general;
    if (all.first >= all.last) return MovedBy::general;
    return is_lumped(all.first) ? MovedBy::fused_lumped : MovedBy::fused;
  }
  CDEM_HD Range elements(Index block) const {
    const Index begin = block * block_size, end = begin + block_size;
    return {begin, end < count ? end : count};
  }
  /// Call visit(lane, corner, node) for the nodes of a fused block.
  template <class Visit>
  CDEM_HD void visit_nodes(Index block, const Visit& visit) const {
    const Range all = elements(block);
    for (Index i = all.first; i < all.last; ++i)
      for (Index k = 0; k < corners; ++k) visit(i - all.first, k, first_node(i) + k);
  }
};

/// Item: place in the list of blocks that are awake.
struct FindMovers {
  FusedElements of;
  const Index* awake;
  Flag* moved_by;  // [block]
  CDEM_HD void operator()(One item) const {
    moved_by[awake[item.i]] = Flag(of.moved_by(awake[item.i]));
  }
};
struct IsMovedBy {
  const Flag* moved_by;
  MovedBy by;
  CDEM_HD bool operator()(One block) const { return MovedBy(moved_by[block.i]) == by; }
};

/// How many places the rows of a fused block take, see FusedRows.
struct CountFusedRows {
  FusedElements of;
  const Flag* moved_by;
  Index* count;
  CDEM_HD void operator()(One block) const {
    Index most = 0;
    if (is_fused(MovedBy(moved_by[block.i])))
      of.visit_nodes(block.i, [&](Index, Index, Index node) {
        const Range bonds = of.bond_rows(node);
        if (bonds.last - bonds.first > most) most = bonds.last - bonds.first;
      });
    count[block.i] = most * of.corners * block_size;
  }
};
/// List these rows, and mark the nodes as fused.
struct PutFusedRows {
  FusedElements of;
  const Flag* moved_by;
  const Index* corner;  // rows of the nodes
  Index nothing;        // the row that adds nothing
  const Index* first;   // [block + 1]
  Index* rows;
  Flag* fused;  // [node]
  Real* force;  // rows of 4

  CDEM_HD void operator()(One block) const {
    if (!is_fused(MovedBy(moved_by[block.i]))) return;
    const Index begin = first[block.i], end = first[block.i + 1];
    const Index most = (end - begin) / (of.corners * block_size);
    for (Index place = begin; place < end; ++place) rows[place] = nothing;
    of.visit_nodes(block.i, [&](Index lane, Index k, Index node) {
      Index place = begin + k * most * block_size + lane;
      const Range bonds = of.bond_rows(node);
      for (Index c = bonds.first; c < bonds.last; ++c, place += block_size) rows[place] = corner[c];
      fused[node] = 1;
      force[4 * std::size_t(node) + 3] = 0;  // no contact stiffens it any more
    });
  }
};

/// Blocks of nodes, of a list, that other kernels move: not all of their nodes are fused.
struct HasGeneralNode {
  Index count;  // nodes
  const Index* blocks;
  const Flag* fused;
  CDEM_HD bool operator()(One item) const {
    const Index begin = blocks[item.i] * block_size;
    for (Index i = begin; i < begin + block_size && i < count; ++i)
      if (!fused[i]) return true;
    return false;
  }
};
/// Take listed items of an array, or, without a list, all.
struct TakeItems {
  const Index *list, *from;
  Index* into;
  CDEM_HD void operator()(One item) const { into[item.i] = from[list ? list[item.i] : item.i]; }
};

}  // namespace cdem
