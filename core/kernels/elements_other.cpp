// elements_other.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as
// CUDA.
#include "core/elements/corotational.hpp"
#include "core/elements/incremental.hpp"
#include "core/elements/tile_loops.hpp"
#if defined(__CUDACC__)  // calls between files cost there
#include "core/materials/flow_by.hpp"
#endif

namespace cdem {

template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Tet4, IgnoreRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Pyramid5, IgnoreRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Wedge6, IgnoreRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Hex8, IgnoreRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Hex8OnePoint, IgnoreRotation>&);
template void for_each_lane(Queue, Index, Blocks, const CorotationalReport<Tet4, IgnoreRotation>&);
template void for_each_lane(Queue, Index, Blocks,
                            const CorotationalReport<Pyramid5, IgnoreRotation>&);
template void for_each_lane(Queue, Index, Blocks,
                            const CorotationalReport<Wedge6, IgnoreRotation>&);
template void for_each_lane(Queue, Index, Blocks, const CorotationalReport<Hex8, IgnoreRotation>&);
template void for_each_lane(Queue, Index, Blocks,
                            const CorotationalReport<Hex8OnePoint, IgnoreRotation>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Tet4, TurnByHalves>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Pyramid5, TurnByHalves>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Wedge6, TurnByHalves>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Hex8, TurnByHalves>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Hex8OnePoint, TurnByHalves>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Tet4, NeverTurn>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Pyramid5, NeverTurn>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Wedge6, NeverTurn>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Hex8, NeverTurn>&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const IncrementalForce<Hex8OnePoint, NeverTurn>&);

}  // namespace cdem
