// narrow_phase.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/contact/narrow_phase/target_edge.hpp"
#include "core/contact/narrow_phase/target_face.hpp"

namespace cdem {

template void for_each_selected(Queue, Index, const KeepTargetFaces&);
template void for_each_selected(Queue, Index, const SiftTargetFaces&);
template void for_each_item(Queue, Index, const FindTargetFaces&);
template void for_each_lane(Queue, Index, const SiftTargetEdges&);
template void for_each_selected(Queue, Index, const TouchTargetEdges&);
template void for_each_item(Queue, Index, const ListEdges&);

}  // namespace cdem
