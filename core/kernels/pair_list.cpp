// pair_list.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/base/primitive_loops.hpp"
#include "core/contact/broad_phase/edge_edge_pairs.hpp"
#include "core/contact/broad_phase/exceeds_skin.hpp"
#include "core/contact/broad_phase/exposed_patches.hpp"
#include "core/contact/broad_phase/near_boxes.hpp"
#include "core/contact/broad_phase/patch_pairs.hpp"
#include "core/contact/force/stiffness_sums.hpp"
#include "core/contact/pair_list/outer_faces.hpp"
#include "core/contact/pair_list/prune.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const MakeExposedFaces&);
template void for_each_item(Queue, Index, const MakeExposedSides&);
template void select_items(Queue, Index, const BeginsPatch&, Column<Index>&);
template void for_each_item(Queue, Index, const MakePatches&);
template void for_each_item(Queue, Index, const ListEdgeSides&);
template void for_each_item(Queue, Index, const CopyRotations&);
template void for_each_item(Queue, Index, const CopyBoxes&);
template void for_each_item(Queue, Index, const GroupBoxes&);
template void for_each_item(Queue, Index, const GroupGroups&);
template void for_each_item(Queue, Index, const FindMortonCodes&);
template void for_each_item(Queue, Index, const FlagNear&);
template void for_each_item(Queue, Index, const FlagOwnPatches&);
template void for_each_item(Queue, Index, const MarkFarPatches&);
template void list_items(Queue, Index, const ListPatchPairs&, Column<PatchPair>&);
template void keep_items(Queue, const MayMeet&, Column<PatchPair>&);
template void for_each_item(Queue, Index, const SortByOther&);
template void keep_items(Queue, const FindMeetingParts&, Column<PatchPair>&);
template void list_items(Queue, Index, const ListVertexFaces&, Column<VertexFaceItem>&);
template void keep_items(Queue, const VertexMayTouch&, Column<VertexFaceItem>&);
template void copy_items(Queue, Index, const PatchPair*, PatchPair*);
template void copy_items(Queue, Index, const VertexFaceItem*, VertexFaceItem*);
template void copy_items(Queue, Index, const EdgeItem*, EdgeItem*);
template void for_each_item(Queue, Index, const WriteVertexFaces&);
template void list_items(Queue, Index, const ListSemiSprings&, Column<Candidate>&);
template void list_rows_in_room(Queue, Index, Index, Index, const RowOfCandidate&, Column<Index>&,
                                Column<Index>&);
template void for_each_item(Queue, Index, const WriteSlotPairs&);
template void for_each_item(Queue, Index, const FindEdges&);
template void for_each_item(Queue, Index, const MakeMovingEdges&);
template void list_items(Queue, Index, const ListEdgesOfPatches&, Column<EdgeItem>&);
template void keep_items(Queue, const EdgesMayTouch&, Column<EdgeItem>&);
template void for_each_item(Queue, Index, const WriteEdgePairs&);
template void list_items(Queue, Index, const ListFacePairs&, Column<FacePair>&);
template void for_each_item(Queue, Index, const MarkListedFaces<ListFacePairs>&);
template void list_rows_in_room(Queue, Index, Index, Index, const RowOfActingFace&, Column<Index>&,
                                Column<Index>&);
template void for_each_item(Queue, Index, const WriteActingFaces&);
template void raise_if_any(Queue, Index, const ExceedsSkin&, Flag*);
template void for_each_item(Queue, Index, const PredictInner&);
template void for_each_lane(Queue, Index, const MarkNearFaces&);
template void for_each_selected(Queue, Index, const MarkInnerFaces&);
template void for_each_item(Queue, Index, const CountInnerFaces&);
template void for_each_item(Queue, Index, const ListInnerFaces&);
template void for_each_lane(Queue, Index, const MarkNearEdges&);
template void for_each_item(Queue, Index, const MarkHeldEdges&);
template void for_each_item(Queue, Index, const JoinPairsOfEdges&);
template void for_each_item(Queue, Index, const CopyInnerEdges&);
template void list_rows_in_room(Queue, Index, Index, Index, const RowOfEdges&, Column<Index>&,
                                Column<Index>&);

}  // namespace cdem
