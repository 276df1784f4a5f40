// exposed_faces.cpp - the loops over kernels of exposed faces, instantiated. Compiled as C++, and
// as CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/contact/narrow_phase/edge_rows.hpp"
#include "core/contact/narrow_phase/list_exposed.hpp"
#include "core/contact/narrow_phase/renewed_faces.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const ListExposed&);
template void for_each_item(Queue, Index, const OwnExposed&);
template bool any_item(Queue, Index, const OpensOrLeaves&);
template void for_each_item(Queue, Index, const FlagExposed&);
template void for_each_item(Queue, Index, const MarkFacesOfPairs&);
template void for_each_item(Queue, Index, const PairPlaces&);
template void for_each_item(Queue, Index, const LeavePlaces&);
template void for_each_item(Queue, Index, const TakePlaces&);
template void for_each_item(Queue, Index, const DropTargetsThatLeave&);
template void for_each_item(Queue, Index, const GatherRows<Flag>&);
template void for_each_item(Queue, Index, const GatherRows<Index>&);
template void for_each_item(Queue, Index, const GatherRows<Real>&);
template void for_each_item(Queue, Index, const CountKeptEdges&);
template void for_each_item(Queue, Index, const MoveKeptEdges&);
template void list_rows_in_room(Queue, Index, Index, Index, const MotherOfEdge&, Column<Index>&,
                                Column<Index>&);
template void for_each_item(Queue, Index, const CountAddedEdges&);
template void for_each_item(Queue, Index, const PutAddedEdges&);

}  // namespace cdem
