// take_out.cpp - see take_out.hpp.
#include "core/run/take_out.hpp"

#include <algorithm>
#include <vector>

#include "core/bolts/bolts.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/pair_list/rebuild.hpp"
#include "core/diagnostics/energy.hpp"
#include "core/materials/laws.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Row of a support that holds a node in all directions.
Index holding_support(Model& m) {
  const Index count = Index(m.support_component.size() / 3);
  const auto holds = [&](Index k) {
    return m.support_component[k] && m.support_curve[k] == 0 && m.support_velocity[k] == 0;
  };
  const Index last = 3 * (count - 1);
  if (count > 0 && holds(last) && holds(last + 1) && holds(last + 2)) return count - 1;
  for (Index axis = 0; axis < 3; ++axis) {
    m.support_component.push(1);
    m.support_curve.push(0);
    m.support_velocity.push(0);
  }
  return count;
}

/// Row of a material without stiffness: it has neither stress nor energy, however deformed.
Index slack_material(Model& m) {
  const Index count = Index(m.material_lambda.size());
  const bool known = count > 0 && m.material_mu[count - 1] == 0;
  const Index row = known ? count - 1 : count;
  if (!known) {
    m.material_lambda.push(0);
    m.material_mu.push(0);
    m.material_law.push(0);
  }
  // a stage that changes these gives them for the materials of the case alone
  m.material_parameters.resize(std::size_t(row + 1) * material_row);
  if (m.water.biot.size() > 0) m.water.biot.resize(row + 1);
  return row;
}

/// Is an item of a set out, or a side of a pair?
template <class Set>
bool is_out(const Model& m, const State& s, const Set& set, Index item) {
  bool out = false;
  for_each_node(m, set, item, [&](Index node) { out |= s.nodes.out[node] != 0; });
  return out;
}

/// What the last sample counted of the half step to come will not be.
void stop_node(NodeState& n, std::size_t i) {
  n.work_external[i] -= n.sample[4 * i + 1];
  n.work_damping[i] -= n.sample[4 * i + 2];
  n.step_change[i] -= n.sample[4 * i + 3];
  for (Column<Real>* rows : {&n.force, &n.reaction, &n.sample})
    for (std::size_t k = 0; k < 4; ++k) (*rows)[4 * i + k] = 0;
  if (n.damping_force.size() > 0)
    for (std::size_t k = 0; k < 4; ++k) n.damping_force[4 * i + k] = 0;
  if (n.relax.size() > 0)
    for (std::size_t k = 0; k < 8; ++k) n.relax[8 * i + k] = k == 3 ? 1 : 0;
  for (std::size_t k = 4; k < 8; ++k) n.motion[8 * i + k] = 0;
  n.unbalance[i] = 0;
}

void relieve(State&, const ElementSet& e, ElementState& es, Index i) {
  es.energy[i] = 0;
  for (std::size_t k = 0; k < es.point_stress.size() / e.stride; ++k)
    es.point_stress[k * e.stride + i] = 0;
}

/// The faces of a pair can be touched then; those that are out are hidden afterwards.
void relieve(State& s, const PairSet& p, PairState& ps, Index i) {
  if (is_live(PairStatus(ps.status[i])))
    for (const Index side : {0, 1}) expose(s, p.faces[2 * i + side]);
  ps.status[i] = Flag(PairStatus::released);
  ps.stored[i] = 0;
  ps.jump[i] = 0;
  ps.jump_at_break[i] = -1;
}

/// The rest of a bolt goes on to hold the rock that stays.
void relieve(State& s, const BoltSet& b, BoltState& bs, Index bolt) {
  cut_bolt(b, s.nodes.out.data(), bs, bolt);
}

}  // namespace

Real stored_energy(const Model& m, const State& s) {
  const Energies e = energies(m, s);
  return e.terms[energy_term("kinetic")] + e.terms[energy_term("strain")] +
         e.terms[energy_term("contact")];
}

void hide_faces(State& s, const std::vector<Flag>& hidden) {
  for (std::size_t x = 0; x < s.search.exposed_face.size(); ++x) {
    if (!hidden[s.search.exposed_face[x]]) continue;
    s.taken_out_friction += s.edges.friction[x];
    s.taken_out_dashpot += s.edges.dashpot[x];
    for (std::size_t slot = 4 * x; slot < 4 * x + 4; ++slot) {
      s.taken_out_friction += s.springs.friction[slot];
      s.taken_out_dashpot += s.springs.dashpot[slot];
    }
  }
  hide(s, hidden);
}

void take_out(Model& m, State& s, const Flag* leaves) {
  const Real before = stored_energy(m, s);
  s.nodes.out.resize(m.node_count);
  for (Index i = 0; i < m.node_count; ++i) {
    if (!leaves[i] || s.nodes.out[i]) continue;
    s.nodes.out[i] = 1;
    stop_node(s.nodes, i);
  }
  for_each_set(m, s, [&](auto, const auto& set, auto& state) {
    for (Index i = 0; i < set.count; ++i)
      if (is_out(m, s, set, i)) relieve(s, set, state, i);
  });
  std::vector<Flag> hidden(m.face_count);
  for (Index f = 0; f < m.face_count; ++f) hidden[f] = s.nodes.out[m.face_nodes[4 * f]];
  hide_faces(s, hidden);
  sort_exposed(s);
  s.taken_out += before - stored_energy(m, s);
  hold_taken_out(m, s);
  list_pairs_of_exposed(m, s, {.everything_awake = true}, true);
}

void hold_taken_out(Model& m, const State& s) {
  if (s.nodes.out.size() == 0) return;
  const Index support = holding_support(m), slack = slack_material(m);
  for (Index i = 0; i < m.node_count; ++i) {
    if (!s.nodes.out[i]) continue;
    m.support[i] = support;
    m.mass_row_first[i] = -1;
    m.gravity_mass[i] = 0;
    for (Index k = 4 * m.load_first[i]; k < 4 * m.load_first[i + 1]; ++k) m.load_force[k] = 0;
  }
  for_each_element_set(m, s, [&](auto, ElementSet& e, const ElementState&) {
    for (Index i = 0; i < e.count; ++i) {
      if (!is_out(m, s, e, i)) continue;
      e.material[i] = slack;
      for (std::size_t k = 0; k < e.hourglass.size() / e.stride; ++k)
        e.hourglass[k * e.stride + i] = 0;
    }
  });
}

}  // namespace cdem
