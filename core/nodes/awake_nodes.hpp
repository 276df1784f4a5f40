// awake_nodes.hpp - kernels that find the nodes which are computed.
#pragma once

#include "core/base/parallel.hpp"

namespace cdem {

/// A node wakes if it does not sleep, or is or was on a pair list; others move the nodes that a
/// rank does not own.
struct FindWakingNodes {
  const Flag* own;  // null: all are
  const Flag* sleeps;
  const Index* contact_first;  // [node + 1]
  Flag *listed, *wakes;
  CDEM_HD void operator()(One node) const {
    const bool was = listed[node.i];
    const bool is = contact_first[node.i] < contact_first[node.i + 1];
    listed[node.i] = is;
    wakes[node.i] = (!sleeps[node.i] || is || was) && (!own || own[node.i]);
  }
};

/// Is a node of a block of `block_size` awake? Nodes that share a mass matrix move together.
struct BlockIsAwake {
  Index count;  // nodes
  const Flag* wakes;
  bool lumped;  // no mass matrices
  const Index *mass_row_first, *block_first, *block_count;

  CDEM_HD bool operator()(One block) const {
    const Index begin = block.i * block_size;
    for (Index i = begin; i < begin + block_size && i < count; ++i)
      if (is_awake(i)) return true;
    return false;
  }

 private:
  CDEM_HD bool is_awake(Index node) const {
    if (wakes[node]) return true;
    const Index first = block_first[node];
    if (lumped || mass_row_first[first] < 0) return false;
    for (Index i = first; i < first + block_count[first]; ++i)
      if (wakes[i]) return true;
    return false;
  }
};

}  // namespace cdem
