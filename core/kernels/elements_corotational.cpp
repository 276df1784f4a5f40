// elements_corotational.cpp - the loops over kernels of this stage, instantiated. Compiled as C++,
// and as CUDA.
#include "core/elements/corotational.hpp"
#include "core/elements/tile_loops.hpp"
#if defined(__CUDACC__)  // calls between files cost there
#include "core/materials/flow_by.hpp"
#endif

namespace cdem {

template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Tet4, FollowRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Pyramid5, FollowRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Wedge6, FollowRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Hex8, FollowRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Hex8OnePoint, FollowRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Tet4, FollowRotation, PointFlow<Tet4>>&);
template void for_each_tile(
    Queue, Index, Blocks, const Tiles&,
    const CorotationalForce<Pyramid5, FollowRotation, PointFlow<Pyramid5>>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Wedge6, FollowRotation, PointFlow<Wedge6>>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Hex8, FollowRotation, PointFlow<Hex8>>&);
template void for_each_tile(
    Queue, Index, Blocks, const Tiles&,
    const CorotationalForce<Hex8OnePoint, FollowRotation, PointFlow<Hex8OnePoint>>&);
template void for_each_lane(Queue, Index, Blocks, const CorotationalReport<Tet4, FollowRotation>&);
template void for_each_lane(Queue, Index, Blocks,
                            const CorotationalReport<Pyramid5, FollowRotation>&);
template void for_each_lane(Queue, Index, Blocks,
                            const CorotationalReport<Wedge6, FollowRotation>&);
template void for_each_lane(Queue, Index, Blocks, const CorotationalReport<Hex8, FollowRotation>&);
template void for_each_lane(Queue, Index, Blocks,
                            const CorotationalReport<Hex8OnePoint, FollowRotation>&);

}  // namespace cdem
