// contact_force.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/contact/force/accumulate.hpp"
#include "core/contact/force/change_of_target.hpp"
#include "core/contact/force/contact_area.hpp"
#include "core/contact/force/edge_force.hpp"
#include "core/contact/force/rolling.hpp"
#include "core/contact/force/spring_force.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const ChangeTargets&);
template void for_each_selected(
    Queue, Index, const WithLaws<UpdateSpringForces<ElasticUnloading>, BrittleAlone>&);
template void for_each_lane(Queue, Index,
                            const WithLaws<UpdateEdgeForces<ElasticUnloading>, BrittleAlone>&);
template void for_each_selected(
    Queue, Index, const WithLaws<UpdateSpringForces<ElasticUnloading>, InterfaceLaws>&);
template void for_each_selected(
    Queue, Index, const WithLaws<UpdateSpringForces<HystereticUnloading>, InterfaceLaws>&);
template void for_each_lane(Queue, Index,
                            const WithLaws<UpdateEdgeForces<ElasticUnloading>, InterfaceLaws>&);
template void for_each_lane(Queue, Index,
                            const WithLaws<UpdateEdgeForces<HystereticUnloading>, InterfaceLaws>&);
template void for_each_item(Queue, Index, const MergeSideHistories&);
template void list_rows_in_room(Queue, Index, Index, Index, const ContactsOf&, Column<Index>&,
                                Column<Index>&);
template void for_each_item(Queue, Index, const SumTouching&);
template void for_each_item(Queue, Index, const ShareAreas&);
template void for_each_item(Queue, Index, const AccumulateFaceForces&);
template void for_each_item(Queue, Index, const UpdateRollingCouples&);
template void for_each_item(Queue, Index, const AddRollingCouples&);

}  // namespace cdem
