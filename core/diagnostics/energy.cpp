// energy.cpp - see energy.hpp.
#include "core/diagnostics/energy.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/primitives.hpp"
#include "core/diagnostics/contact_energy.hpp"
#include "core/diagnostics/round_off.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

Real largest_term(const Energies& e) {
  Real largest = std::abs(e.start);
  for (const Real term : e.terms) largest = std::max(largest, std::abs(term));
  return largest;
}

/// Contribution of a term to stored plus lost minus supplied energy  [J].
Real counted(EnergyKind kind, Real term) {
  switch (kind) {
    case EnergyKind::supplied:
      return -term;
    case EnergyKind::hidden:
      return std::max(term, 0.0);
    default:
      return term;
  }
}

Real balance(const Energies& e) {
  Real sum = 0;
  for (std::size_t k = 0; k < energy_term_count; ++k)
    sum += counted(energy_terms[k].kind, e.terms[k]);
  return sum;
}

/// The terms without start and error.
Energies sum_terms(const Model& m, const State& s) {
  const Queue q;
  const Counted nodes = s.share.counted("nodes"), faces = s.share.counted("exposed"),
                slots = s.share.counted("slots");
  const auto sample = [&](int k) {
    return exact_sum(q, m.node_count, EachNumber<4>{s.nodes.sample.data() + k}, nodes);
  };
  Energies e;
  Real &contact = e.terms[energy_term("contact")], &friction = e.terms[energy_term("friction")];
  e.terms[energy_term("kinetic")] = sample(0);
  e.terms[energy_term("step_change")] = column_sum(q, s.nodes.step_change, nodes) - sample(3);
  Real& external = e.terms[energy_term("external")];
  external = column_sum(q, s.nodes.work_external, nodes) - sample(1);
  Modules::for_each_of<Port::applied>([&]<class Module>() {  // loads with a term of their own
    const Real work = column_sum(q, applied_of<Module>(s).work, nodes);
    e.terms[energy_term(Module::name)] = work;
    external -= work;
  });
  e.terms[energy_term("radiated")] =
      column_sum(q, s.nodes.radiated, nodes) - column_sum(q, s.nodes.radiated_sample, nodes);
  e.terms[energy_term("damping")] = column_sum(q, s.nodes.work_damping, nodes) - sample(2) +
                                    s.stopped_energy + column_sum(q, s.springs.dashpot, slots) +
                                    column_sum(q, s.edges.dashpot, faces) + s.taken_out_dashpot;
  const Index exposed = Index(s.search.exposed_face.size());
  const Real* const spring = s.springs.state.data();
  contact = exact_sum(q, 4 * exposed, StoredNormal{spring}, slots) +
            exact_sum(q, 4 * exposed, StoredShear{spring}, slots);
  contact += exact_sum(q, Index(s.springs.rolling.size() / 8),
                       StoredRolling{s.springs.rolling.data()}, slots);
  contact +=
      exact_sum(q, exposed, StoredInEdges{s.edges.first.data(), s.edges.state.data()}, faces);
  friction = column_sum(q, s.springs.friction, slots) + column_sum(q, s.edges.friction, faces) +
             s.taken_out_friction;
  e.terms[energy_term("taken_out")] = s.taken_out;
  for_each_set(m, s, [&](const auto& kind, const auto&, const auto& state) {
    const Counted own = s.share.counted(kind.name);
    for_each_energy(state, [&](std::size_t term, const Column<Real>& column) {
      e.terms[term] += column_sum(q, column, own);
    });
  });
  return e;
}

}  // namespace

Energies energies(const Model& m, const State& s) {
  Energies e = sum_terms(m, s);
  e.start = s.energy_start;
  const Real open = balance(e) - e.start;
  const Real scale = std::max(s.energy_scale, largest_term(e));
  const RoundOff nothing(m, s);
  e.error = scale > 100 * nothing.force * nothing.shift ? open / scale : 0;
  return e;
}

void keep_energy_scale(const Model& m, State& s) {
  s.energy_scale = std::max(s.energy_scale, largest_term(energies(m, s)));
}

void close_ledger(const Model& m, State& s) {
  s.stopped_energy += s.energy_start - balance(sum_terms(m, s));
}

void open_ledger(const Model& m, State& s) {
  s.ledger_started = true;
  // the first sample may come later than the first step: count losses and work until then
  s.energy_start = balance(sum_terms(m, s));
}

}  // namespace cdem
