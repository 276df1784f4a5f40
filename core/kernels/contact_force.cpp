// contact_force.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/contact/force/accumulate.hpp"
#include "core/contact/force/edge_force.hpp"
#include "core/contact/force/spring_force.hpp"

namespace cdem {

template void for_each_selected(Queue, Index, const UpdateSpringForces&);
template void for_each_lane(Queue, Index, const UpdateEdgeForces&);
template void for_each_item(Queue, Index, const CountActing&);
template void for_each_item(Queue, Index, const ListActing&);
template void for_each_item(Queue, Index, const GatherFaceForces&);

}  // namespace cdem
