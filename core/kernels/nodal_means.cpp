// nodal_means.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as
// CUDA.
#include "core/elements/nodal_dilatation.hpp"
#include "core/elements/tile_loops.hpp"
#if defined(__CUDACC__)  // calls between files cost there
#include "core/materials/flow_by.hpp"
#endif

namespace cdem {

template void for_each_lane(Queue, Index, Blocks, const FindDilatation&);
template void for_each_item(Queue, Index, const AverageAtNodes&);
template void for_each_lane(Queue, Index, Blocks, const FlowOfTets&);
template void for_each_tile(Queue, Index, Blocks, const Tiles&,
                            const CorotationalForce<Tet4, FollowRotation, NodalFlow>&);
template void for_each_lane(Queue, Index, Blocks,
                            const CorotationalReport<Tet4, FollowRotation, NodalReport>&);

}  // namespace cdem
