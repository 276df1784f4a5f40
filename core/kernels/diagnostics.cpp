// diagnostics.cpp - primitives over kernels of this folder, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/diagnostics/contact_energy.hpp"
#include "core/diagnostics/force_terms.hpp"
#include "core/diagnostics/node_health.hpp"

namespace cdem {

template void find_most(Queue, Index, const SquaredSpeed&, Answer<Most>&);
template void find_most(Queue, Index, const LostContact&, Answer<Most>&);
template Most most(Queue, Index, const Farthest&);
template Real exact_sum(Queue, Index, const NodeStiffness&);
template Real exact_sum(Queue, Index, const AppliedForce&);
template Real exact_sum(Queue, Index, const CarriedForce&);
template Real exact_sum(Queue, Index, const StoredNormal&);
template Real exact_sum(Queue, Index, const StoredShear&);
template Real exact_sum(Queue, Index, const StoredRolling&);
template Real exact_sum(Queue, Index, const StoredInEdges&);

}  // namespace cdem
