// pair_list.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/base/primitive_loops.hpp"
#include "core/contact/broad_phase/exceeds_skin.hpp"
#include "core/contact/pair_list/prune.hpp"

namespace cdem {

template bool any_item(Queue, Index, const ExceedsSkin&);
template void for_each_item(Queue, Index, const PredictInner&);
template void for_each_lane(Queue, Index, const MarkNearFaces&);
template void for_each_selected(Queue, Index, const MarkInnerFaces&);
template void for_each_item(Queue, Index, const CountInnerFaces&);
template void for_each_item(Queue, Index, const ListInnerFaces&);
template void for_each_lane(Queue, Index, const MarkNearEdges&);
template void for_each_item(Queue, Index, const MarkHeldEdges&);
template void for_each_item(Queue, Index, const JoinPairsOfEdges&);
template void for_each_item(Queue, Index, const CopyInnerEdges&);
template void for_each_item(Queue, Index, const SetOtherEdge&);
template void select_items(Queue, Index, const IsNear&, Column<Index>&);
template void list_rows(Queue, Index, Index, Index, const RowOfEdges&, Column<Index>&,
                        Column<Index>&);

}  // namespace cdem
