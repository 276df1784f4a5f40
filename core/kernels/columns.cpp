// columns.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/columns/side.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const AdvanceColumns&);
template void for_each_item(Queue, Index, const SideForces&);

}  // namespace cdem
