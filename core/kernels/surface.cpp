// surface.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/surface/act_on_faces.hpp"

namespace cdem {

template void for_each_lane(Queue, Index, const ActOnFaces<SurfaceLaws, 3>&);
template void for_each_lane(Queue, Index, const ActOnFaces<SurfaceLaws, 4>&);

}  // namespace cdem
