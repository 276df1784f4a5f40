// node_lists.cpp - the loops over kernels that list nodes and blocks, instantiated. Compiled as
// C++, and as CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/nodes/awake_nodes.hpp"
#include "core/nodes/fused_elements.hpp"
#include "core/nodes/live_corners.hpp"
#include "core/nodes/lumped_blocks.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const MarkLiveRows&);
template void list_items(Queue, Index, const LiveCorners&, Column<Index>&, Column<Index>&);
template void for_each_item(Queue, Index, const MarkBlocksOfNodes&);
template void for_each_item(Queue, Index, const MarkBondedBlocks&);
template void for_each_item(Queue, Index, const SpreadInBlock&);
template bool any_item(Queue, Index, const FlagsDiffer&);
template void for_each_item(Queue, Index, const CountInSample&);
template void for_each_item(Queue, Index, const FindWakingNodes&);
template void select_items(Queue, Index, const BlockIsAwake&, Column<Index>&);
template void for_each_item(Queue, Index, const FindMovers&);
template void select_items(Queue, Index, const IsMovedBy&, Column<Index>&);
template void for_each_item(Queue, Index, const CountFusedRows&);
template void for_each_item(Queue, Index, const PutFusedRows&);
template void select_items(Queue, Index, const HasGeneralNode&, Column<Index>&);
template void for_each_item(Queue, Index, const TakeItems&);

}  // namespace cdem
