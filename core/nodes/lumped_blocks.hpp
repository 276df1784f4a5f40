// lumped_blocks.hpp - kernels that find the blocks which move lumped masses.
#pragma once

#include "core/base/parallel.hpp"
#include "core/nodes/node_energy.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

/// Flag the first nodes of the blocks of listed nodes.
struct MarkBlocksOfNodes {
  const Index *nodes, *block_first;
  Flag* whole;  // [node]
  CDEM_HD void operator()(One item) const { set(whole[block_first[nodes[item.i]]]); }
};
/// The same of the blocks of live pairs.
struct MarkBondedBlocks {
  const Flag* status;
  const Index *faces, *face_nodes;  // of a pair: its faces belong to a block each
  const Index* block_first;
  Flag* whole;
  CDEM_HD void operator()(One pair) const {
    if (!is_live(PairStatus(status[pair.i]))) return;
    for (Index side = 0; side < 2; ++side)
      set(whole[block_first[face_nodes[4 * std::size_t(faces[2 * pair.i + side])]]]);
  }
};
/// All nodes of a block have the flag of its first.
struct SpreadInBlock {
  const Flag* whole;
  const Index* block_first;
  Flag* flags;
  CDEM_HD void operator()(One node) const { flags[node.i] = whole[block_first[node.i]]; }
};
struct FlagsDiffer {
  const Flag *one, *other;
  CDEM_HD bool operator()(One node) const { return one[node.i] != other[node.i]; }
};

/// Add a node's energy of motion to its sample, or take it away.
struct CountInSample {
  KineticEnergy energy;
  Real sign;
  Real* sample;  // rows of 4
  CDEM_HD void operator()(One node) const {
    sample[4 * std::size_t(node.i)] += sign * energy(node);
  }
};

}  // namespace cdem
