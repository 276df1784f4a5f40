// bonds.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/bonds/bond_dashpots.hpp"
#include "core/bonds/bonded_overlaps.hpp"
#include "core/bonds/broken_pairs.hpp"
#include "core/bonds/conforming_transfer.hpp"
#include "core/bonds/give_history.hpp"
#include "core/bonds/hinges.hpp"
#include "core/bonds/joined_nodes.hpp"
#include "core/bonds/overlap_transfer.hpp"
#include "core/bonds/release_pairs.hpp"
#include "core/bonds/surface_rows.hpp"

namespace cdem {

template void raise_if_any(Queue, Index, const HasMovedFar&, Flag*);
template void select_items(Queue, Index, const HasMovedFar&, Column<Index>&);
template void select_items(Queue, Index, const IsBonded&, Column<Index>&);
template void for_each_item(Queue, Index, const WriteBondedKeys&);
template void select_items(Queue, Index, const OpensAsHinge<BrokenOfConforming<3>>&,
                           Column<Index>&);
template void select_items(Queue, Index, const OpensAsHinge<BrokenOfConforming<4>>&,
                           Column<Index>&);
template void select_items(Queue, Index, const OpensAsHinge<BrokenOfOverlaps>&, Column<Index>&);
template void for_each_item(Queue, Index, const OpenHinge<BrokenOfConforming<3>>&);
template void for_each_item(Queue, Index, const OpenHinge<BrokenOfConforming<4>>&);
template void for_each_item(Queue, Index, const OpenHinge<BrokenOfOverlaps>&);
template void list_rows_in_room(Queue, Index, Index, Index, const PairSides&, Column<Index>&,
                                Column<Index>&);
template void for_each_item(Queue, Index, const GiveHistory&);
template void for_each_item(Queue, Index, const TransferToContacts&);
template void list_items(Queue, Index, const ListBonded&, Column<Index>&);
template void for_each_item(Queue, Index, const ReleasePairs&);
template void list_items(Queue, Index, const ListLifted&, Column<Index>&);
template void for_each_item(Queue, Index, const AwaitSprings&);
template void list_items(Queue, Index, const ListAwaitedEdges&, Column<EdgeContact>&);
template void for_each_item(Queue, Index, const CountNewStates&);
template void for_each_item(Queue, Index, const GiveToSuccessors&);
template void for_each_item(Queue, Index, const StartLabels&);
template void for_each_item(Queue, Index, const JoinBondedNodes&);
template void for_each_item(Queue, Index, const JoinBodies&);
template void for_each_item(Queue, Index, const FinishLabels&);
template void for_each_item(Queue, Index, const NumberOfNode&);
template void for_each_item(Queue, Index, const LowerLabels&);
template bool any_item(Queue, Index, const IsToldLower&);
template void for_each_item(Queue, Index, const TellLowest&);
template void for_each_item(Queue, Index, const KeysOfLowest&);
template void for_each_item(Queue, Index, const JoinSameKeys&);
template void for_each_item(Queue, Index, const MarkExposedPoints&);
template void list_rows(Queue, Index, Index, Index, const EdgesOfPoints&, Column<Index>&,
                        Column<Index>&);
template void list_items(Queue, Index, const EndsOfPoints&, Column<Index>&, Column<Index>&);
template void for_each_item(Queue, Index, const FindMates&);
template void for_each_item(Queue, Index, const FindAcross&);
template void for_each_lane(Queue, Index, Blocks, const BondDashpots<3>&);
template void for_each_lane(Queue, Index, Blocks, const BondDashpots<4>&);
template void for_each_item(Queue, Index, Blocks, const OverlapDashpots&);
template void for_each_lane(Queue, Index, Blocks,
                            const WithLaws<ConformingBonds<3>, BrittleAlone>&);
template void for_each_lane(Queue, Index, Blocks,
                            const WithLaws<ConformingBonds<4>, BrittleAlone>&);
template void for_each_item(Queue, Index, Blocks, const WithLaws<OverlapBonds, BrittleAlone>&);
template void for_each_lane(Queue, Index, Blocks,
                            const WithLaws<ConformingBonds<3>, InterfaceLaws>&);
template void for_each_lane(Queue, Index, Blocks,
                            const WithLaws<ConformingBonds<4>, InterfaceLaws>&);
template void for_each_item(Queue, Index, Blocks, const WithLaws<OverlapBonds, InterfaceLaws>&);

}  // namespace cdem
