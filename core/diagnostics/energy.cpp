// energy.cpp - see energy.hpp.
#include "core/diagnostics/energy.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/exact_sum.hpp"
#include "core/diagnostics/round_off.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

Real largest_term(const Energies& e) {
  Real largest = std::abs(e.start);
  for (const Real term : e.terms) largest = std::max(largest, std::abs(term));
  return largest;
}

/// What a term adds to what is stored and lost, less what was supplied  [J].
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
  const auto samples = on_host(s.nodes.sample);
  const auto sample = [&](int k) {
    return exact_sum(m.node_count, [&](Index i) { return samples[4 * std::size_t(i) + k]; });
  };
  Energies e;
  Real &contact = e.terms[energy_term("contact")], &friction = e.terms[energy_term("friction")];
  e.terms[energy_term("kinetic")] = sample(0);
  e.terms[energy_term("step_change")] = column_sum(s.nodes.step_change) - sample(3);
  e.terms[energy_term("water")] = column_sum(s.nodes.work_water);  // a load like the others
  e.terms[energy_term("external")] =
      column_sum(s.nodes.work_external) - sample(1) - e.terms[energy_term("water")];
  e.terms[energy_term("damping")] = column_sum(s.nodes.work_damping) - sample(2) +
                                    s.stopped_energy + column_sum(s.springs.dashpot) +
                                    column_sum(s.edges.dashpot) + s.taken_out_dashpot;
  const Index exposed = Index(s.search.exposed_face.size());
  const auto springs = on_host(s.springs.state), rolling = on_host(s.springs.rolling);
  const auto spring = [&](Index slot) { return ContactState::at(springs.data(), slot); };
  contact = exact_sum(4 * exposed, [&](Index i) { return spring(i).energy_n; }) +
            exact_sum(4 * exposed, [&](Index i) { return spring(i).energy_s; });
  if (rolling.size() > 0)
    contact +=
        exact_sum(4 * exposed, [&](Index i) { return RollingState::at(rolling.data(), i).energy; });
  const auto first = on_host(s.edges.first);
  const auto edges = on_host(s.edges.state);
  contact += exact_sum(exposed, [&](Index i) {
    Real sum = 0;
    for (Index c = first[i]; c < first[i + 1]; ++c) {
      const ContactState edge = ContactState::at(edges.data(), c);
      sum += edge.energy_n + edge.energy_s;
    }
    return sum;
  });
  friction = column_sum(s.springs.friction) + column_sum(s.edges.friction) + s.taken_out_friction;
  e.terms[energy_term("taken_out")] = s.taken_out;
  for_each_set(m, s, [&](auto, const auto&, const auto& state) {
    for_each_energy(state, [&](std::size_t term, const Column<Real>& column) {
      e.terms[term] += column_sum(column);
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

void open_ledger(const Model& m, State& s) {
  const Transfer transfer;
  s.ledger_started = true;
  // the first sample may come later than the first step: count what has been lost and done by then
  s.energy_start = balance(sum_terms(m, s));
}

}  // namespace cdem
