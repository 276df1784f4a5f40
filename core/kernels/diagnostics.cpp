// diagnostics.cpp - primitives over kernels of this folder, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/diagnostics/node_health.hpp"

namespace cdem {

template Most most(Queue, Index, const SquaredSpeed&);
template Most most(Queue, Index, const LostContact&);

}  // namespace cdem
