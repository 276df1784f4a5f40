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
  on_threads(kernel.node_count >= worth_threads, [&](Thread thread) {
    const Range part = thread.part_of(count);
    for (Index i = part.first; i < part.last; ++i) kernel(One{i});
  });
}
#endif

}  // namespace cdem
