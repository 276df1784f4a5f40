// fused_blocks.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/nodes/fused_block.hpp"
#if defined(__CUDACC__)  // calls between files cost there
#include "core/materials/flow_by.hpp"
#endif

namespace cdem {

template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Tet4, false>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Tet4, true>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Hex8, false>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Hex8, true>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Hex8OnePoint, false>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Hex8OnePoint, true>&);
template void for_each_lane(Queue, Index, Blocks,
                            const AdvanceFused<Tet4, false, PointFlow<Tet4>>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Tet4, true, PointFlow<Tet4>>&);
template void for_each_lane(Queue, Index, Blocks,
                            const AdvanceFused<Hex8, false, PointFlow<Hex8>>&);
template void for_each_lane(Queue, Index, Blocks, const AdvanceFused<Hex8, true, PointFlow<Hex8>>&);
template void for_each_lane(Queue, Index, Blocks,
                            const AdvanceFused<Hex8OnePoint, false, PointFlow<Hex8OnePoint>>&);
template void for_each_lane(Queue, Index, Blocks,
                            const AdvanceFused<Hex8OnePoint, true, PointFlow<Hex8OnePoint>>&);

}  // namespace cdem
