// diagnostics.cpp - primitives over kernels of this folder, instantiated. Compiled as C++, and as
// CUDA.
#include "core/base/primitive_loops.hpp"
#include "core/diagnostics/contact_energy.hpp"
#include "core/diagnostics/force_terms.hpp"
#include "core/diagnostics/node_health.hpp"

namespace cdem {

template void find_most(Queue, Index, const SquaredSpeed&, const Flag*, Answer<Most>&);
template void find_most(Queue, Index, const LostContact&, const Flag*, Answer<Most>&);
template Most most(Queue, Index, const Farthest&, const Flag*);
template Real exact_sum(Queue, Index, const NodeStiffness&, const Counted&);
template Real exact_sum(Queue, Index, const AppliedForce&, const Counted&);
template Real exact_sum(Queue, Index, const CarriedForce&, const Counted&);
template Real exact_sum(Queue, Index, const StoredNormal&, const Counted&);
template Real exact_sum(Queue, Index, const StoredShear&, const Counted&);
template Real exact_sum(Queue, Index, const StoredRolling&, const Counted&);
template Real exact_sum(Queue, Index, const StoredInEdges&, const Counted&);

}  // namespace cdem
