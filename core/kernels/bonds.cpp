// bonds.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/bonds/bonded_pairs.hpp"

namespace cdem {

template void for_each_lane(Queue, Index, Blocks, const ConformingBonds<3>&);
template void for_each_lane(Queue, Index, Blocks, const ConformingBonds<4>&);
template void for_each_item(Queue, Index, Blocks, const OverlapBonds&);

}  // namespace cdem
