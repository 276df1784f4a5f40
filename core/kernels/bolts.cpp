// bolts.cpp - the loop over the kernel of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/bolts/solve_bolts.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const SolveBolt&);

}  // namespace cdem
