// nodes.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/nodes/central_difference.hpp"
#include "core/nodes/contact_corners.hpp"
#include "core/nodes/node_energy.hpp"
#include "core/nodes/node_frequency.hpp"
#include "core/nodes/peak_speed.hpp"
#include "core/nodes/relaxing_node.hpp"
#include "core/nodes/sum_applied.hpp"

namespace cdem {

template void for_each_item(Queue, Index, Blocks, const SumNodeForces&);
template void for_each_item(Queue, Index, Blocks, const MoveNodes<NoDashpots>&);
template void for_each_item(Queue, Index, Blocks, const MoveNodes<Dashpots>&);
template void for_each_item(Queue, Index, Blocks, const AdvanceNodes<NoDashpots>&);
template void for_each_item(Queue, Index, Blocks, const AdvanceNodes<Dashpots>&);
template void for_each_item(Queue, Index, const SampleDashpots&);
template void for_each_item(Queue, Index, const NodeMomentum&);
template void for_each_item(Queue, Index, const KeepPeak&);
template void find_most(Queue, Index, const NodeFrequency&, const Flag*, Answer<Most>&);
template void for_each_item(Queue, Index, const DescribeHighest&);
template void list_rows(Queue, Index, Index, Index, const ContactCorners&, Column<Index>&,
                        Column<Index>&);
template void for_each_item(Queue, Index, const SampleNodes&);
template void for_each_item(Queue, Index, const SumApplied&);
template void for_each_item(Queue, Index, const AddApplied&);
template Real exact_sum(Queue, Index, const KineticEnergy&, const Counted&);
template Real exact_sum(Queue, Index, const StopNode&, const Counted&);
template void for_each_item(Queue, Index, const RememberNode&);
template void for_each_item(Queue, Index, const SlowNode&);
template Real exact_sum(Queue, Index, const SlowedWork&, const Counted&);
template Real exact_sum(Queue, Index, const StiffnessInMotion&, const Counted&);
template Real exact_sum(Queue, Index, const MassInMotion&, const Counted&);

}  // namespace cdem
