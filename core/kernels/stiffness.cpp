// stiffness.cpp - the loops over kernels that sum stiffness, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/contact/force/stiffness_sums.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const SumBondStiffness&);
template void for_each_item(Queue, Index, const SumContactStiffness&);

}  // namespace cdem
