// ranks.cpp - the loops over kernels of this folder, instantiated. Compiled as C++, and as CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/ranks/ghosts.hpp"

namespace cdem {

template void for_each_item(Queue, Index, const PackRows&);
template void for_each_item(Queue, Index, const UnpackRows&);

}  // namespace cdem
