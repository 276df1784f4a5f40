// fused_blocks.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/nodes/fused_block.hpp"
#if defined(__CUDACC__)  // calls between files cost there
#include "core/materials/flow_by.hpp"
#endif

namespace cdem {

template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Tet4>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Tet4, PointFlow<Tet4>>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Hex8>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Hex8OnePoint>&);

}  // namespace cdem
