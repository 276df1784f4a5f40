// rest.cpp - the loops over kernels of this folder, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/base/primitive_loops.hpp"
#include "core/rest/moved_node.hpp"
#include "core/rest/products.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const MultiplyRow<3, 3, Into::replace>&);
template void for_each_item(Queue, Index, const MultiplyRow<3, 6, Into::replace>&);
template void for_each_item(Queue, Index, const MultiplyRow<6, 3, Into::replace>&);
template void for_each_item(Queue, Index, const MultiplyRow<6, 6, Into::replace>&);
template void for_each_item(Queue, Index, const MultiplyRow<3, 3, Into::add>&);
template void for_each_item(Queue, Index, const MultiplyRow<3, 6, Into::add>&);
template void for_each_item(Queue, Index, const MultiplyRow<6, 3, Into::add>&);
template void for_each_item(Queue, Index, const MultiplyRow<6, 6, Into::add>&);
template void for_each_item(Queue, Index, const MultiplyRow<3, 3, Into::take_from>&);
template void for_each_item(Queue, Index, const MultiplyRow<3, 6, Into::take_from>&);
template void for_each_item(Queue, Index, const MultiplyRow<6, 3, Into::take_from>&);
template void for_each_item(Queue, Index, const MultiplyRow<6, 6, Into::take_from>&);
template void for_each_item(Queue, Index, const SmoothGroup&);
template void for_each_item(Queue, Index, const Combine&);
template void for_each_item(Queue, Index, const UnbalancedForce&);
template void for_each_item(Queue, Index, const MoveToRest&);
template void for_each_item(Queue, Index, const StopAtRest&);
template Real exact_sum(Queue, Index, const DotOfThree&, const Counted&);

}  // namespace cdem
