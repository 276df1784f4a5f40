// energy.cpp - see energy.hpp.
#include "core/diagnostics/energy.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/reduce.hpp"
#include "core/diagnostics/round_off.hpp"

namespace cdem {

namespace {

Real largest_term(const Energies& e) {
  Real largest = 0;
  for (const Real term : {e.kinetic, e.strain, e.contact, e.friction, e.damping, e.plastic,
                          e.fracture, e.external, e.start})
    largest = std::max(largest, std::abs(term));
  return largest;
}

}  // namespace

void keep_energy_scale(const Model& m, State& s) {
  s.energy_scale = std::max(s.energy_scale, largest_term(energies(m, s)));
}

Energies energies(const Model& m, const State& s) {
  const auto sample = [&](int k) {
    return ordered_sum(m.node_count,
                       [&](Index i) { return s.nodes.sample[4 * std::size_t(i) + k]; });
  };
  Energies e;
  e.kinetic = sample(0);
  e.external = column_sum(s.nodes.work_external) - sample(1);
  e.damping = column_sum(s.nodes.work_damping) - sample(2) + s.stopped_energy +
              column_sum(s.springs.dashpot) + column_sum(s.edges.dashpot);
  for (const ElementState* es : {&s.tet4, &s.pyramid5, &s.wedge6, &s.hex8}) {
    e.strain += column_sum(es->energy);
    e.damping += column_sum(es->damping_work);
    e.plastic += column_sum(es->plastic_work);
  }
  const Index exposed = Index(s.search.exposed_face.size());
  const auto spring = [&](Index slot) { return ContactState::at(s.springs.state.data(), slot); };
  e.contact = ordered_sum(4 * exposed, [&](Index i) { return spring(i).energy_n; }) +
              ordered_sum(4 * exposed, [&](Index i) { return spring(i).energy_s; });
  e.contact += ordered_sum(exposed, [&](Index i) {
    Real sum = 0;
    for (Index c = s.edges.first[i]; c < s.edges.first[i + 1]; ++c) {
      const ContactState edge = ContactState::at(s.edges.state.data(), c);
      sum += edge.energy_n + edge.energy_s;
    }
    return sum;
  });
  e.friction = column_sum(s.springs.friction) + column_sum(s.edges.friction);
  for (const PairState* p : {&s.triangles, &s.quads, &s.overlaps}) {
    e.contact += column_sum(p->stored);
    e.friction += column_sum(p->friction);
    e.fracture += column_sum(p->fracture);
  }
  e.start = s.energy_start;
  const Real open = e.kinetic + e.strain + e.contact + e.friction + e.damping + e.plastic +
                    e.fracture - e.external - e.start;
  const Real scale = std::max(s.energy_scale, largest_term(e));
  const RoundOff nothing(m, s);
  e.error = scale > 100 * nothing.force * nothing.shift ? open / scale : 0;
  return e;
}

void open_ledger(const Model& m, State& s) {
  s.ledger_started = true;
  const Energies e = energies(m, s);
  // the first sample may come later than the first step: count what has been lost and done by then
  s.energy_start = e.kinetic + e.strain + e.contact + e.friction + e.damping + e.plastic +
                   e.fracture - e.external;
}

}  // namespace cdem
