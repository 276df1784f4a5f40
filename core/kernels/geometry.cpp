// geometry.cpp - the loops over kernels of this stage, instantiated. Compiled as C++, and as CUDA.
#include "core/base/parallel_loops.hpp"
#include "core/contact/geometry/face_geometry.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const UpdateFaceGeometry&);
template void for_each_item(Queue, Index, const MarkSharpSides&);

}  // namespace cdem
