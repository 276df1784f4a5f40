// predicted_motion.cpp - the loops over kernels of predicted nodes, instantiated. Compiled as C++,
// and as CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/contact/broad_phase/predict_nodes.hpp"

namespace cdem {

template void list_rows_in_room(Queue, Index, Index, Index, const CornersByNode&, Column<Index>&,
                                Column<Index>&);
template void for_each_item(Queue, Index, const LowerLengths&);
template void select_items(Queue, Index, const IsOnExposed&, Column<Index>&);
template void for_each_item(Queue, Index, const PlacePredicted&);
template void for_each_item(Queue, Index, const PredictNodes&);
template void for_each_item(Queue, Index, const ListComingPaths&);
template void for_each_item(Queue, Index, const PathsByNode&);
template void for_each_item(Queue, Index, const TakePaths&);
template bool any_item(Queue, Index, const LeavesFence&);

}  // namespace cdem
