// water.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/water/pressure.hpp"

namespace cdem {

template void for_each_lane(Queue, Index, const PressOnFaces<3>&);
template void for_each_lane(Queue, Index, const PressOnFaces<4>&);
template void for_each_lane(Queue, Index, const PressInPores<Tet4>&);
template void for_each_lane(Queue, Index, const PressInPores<Pyramid5>&);
template void for_each_lane(Queue, Index, const PressInPores<Wedge6>&);
template void for_each_lane(Queue, Index, const PressInPores<Hex8>&);
template void for_each_lane(Queue, Index, const PressInPores<Hex8OnePoint>&);
template void for_each_item(Queue, Index, const PoresOfNodes&);

}  // namespace cdem
