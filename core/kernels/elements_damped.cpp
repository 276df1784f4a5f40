// elements_damped.cpp - the loops over kernels of rock with damping that remembers, instantiated.
// Compiled as C++, and as CUDA.
#include "core/elements/nodal_dilatation.hpp"
#include "core/elements/rock_damping.hpp"
#include "core/elements/tile_loops.hpp"
#if defined(__CUDACC__)  // calls between files cost there
#include "core/materials/flow_by.hpp"
#endif

namespace cdem {

template <class Shape, class Flow = PointFlow<Shape>>
using DampedForce = CorotationalForce<Shape, FollowRotation, Flow, RockDamping<Shape>>;
template <class Shape, class Flow = PointFlow<Shape>>
using DampedReport = CorotationalReport<Shape, FollowRotation, Flow, RockDamping<Shape>>;

template void for_each_tile(Queue, Index, Blocks, const Tiles&, const DampedForce<Tet4>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&, const DampedForce<Pyramid5>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&, const DampedForce<Wedge6>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&, const DampedForce<Hex8>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&, const DampedForce<Hex8OnePoint>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const DampedForce<Tet4, NodalFlow>&);
template void for_each_lane(Queue, Index, Blocks, const DampedReport<Tet4>&);
template void for_each_lane(Queue, Index, Blocks, const DampedReport<Pyramid5>&);
template void for_each_lane(Queue, Index, Blocks, const DampedReport<Wedge6>&);
template void for_each_lane(Queue, Index, Blocks, const DampedReport<Hex8>&);
template void for_each_lane(Queue, Index, Blocks, const DampedReport<Hex8OnePoint>&);
template void for_each_lane(Queue, Index, Blocks, const DampedReport<Tet4, NodalReport>&);

}  // namespace cdem
