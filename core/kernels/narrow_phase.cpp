// narrow_phase.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/contact/narrow_phase/soft_rim.hpp"
#include "core/contact/narrow_phase/target_edge.hpp"
#include "core/contact/narrow_phase/target_face.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const BeginTargets&);
template void for_each_selected(Queue, Index, const UpdateHeldTargets&);
template void for_each_selected(Queue, Index, const FilterNewTargets&);
template void for_each_item(Queue, Index, const DropPassedTargets&);
template void for_each_item(Queue, Index, const ResolveTargets&);
template void for_each_item(Queue, Index, const HoldAtRims&);
template void for_each_item(Queue, Index, const DropHiddenEdges&);
template void for_each_selected(Queue, Index, const FindHeldEdges&);
template void for_each_lane(Queue, Index, const FilterEdgePairs&);
template void for_each_item(Queue, Index, const RecallHeldEdges&);
template void for_each_selected(Queue, Index, const ResolveTargetEdges&);
template void list_rows(Queue, Index, Index, Index, const FoundEdges&, Column<Index>&,
                        Column<Index>&);
template void for_each_item(Queue, Index, const ListEdgeContacts&);

}  // namespace cdem
