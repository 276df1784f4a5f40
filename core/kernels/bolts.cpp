// bolts.cpp - the loop over the kernel of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/bolts/solve_bolts.hpp"

namespace cdem {

#if !defined(CDEM_CPU)
template void for_each_item(Queue, Index, const SolveBolt&);
#else
/// A bolt is as much work as its nodes are: a few are worth threads.
template <>
void for_each_item(Queue, Index count, const SolveBolt& kernel) {
#pragma omp parallel for schedule(static) if (kernel.node_count >= worth_threads)
  for (Index i = 0; i < count; ++i) kernel(One{i});
}
#endif

}  // namespace cdem
