// take_out.cpp - see take_out.hpp.
#include "core/run/take_out.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/pair_list/rebuild.hpp"
#include "core/diagnostics/energy.hpp"
#include "core/model/describe_model.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Row of a support that holds a node in all directions.
Index holding_support(Model& m) {
  const Index count = Index(m.support_component.size() / 3), last = 3 * (count - 1);
  const auto component = on_host(m.support_component);
  const auto curve = on_host(m.support_curve);
  const auto velocity = on_host(m.support_velocity);
  const auto holds = [&](Index k) { return component[k] && curve[k] == 0 && velocity[k] == 0; };
  if (count > 0 && holds(last) && holds(last + 1) && holds(last + 2)) return count - 1;
  m.support_component.resize(3 * count + 3, 1);
  m.support_curve.resize(3 * count + 3, 0);
  m.support_velocity.resize(3 * count + 3, 0);
  return count;
}

/// Row of a material without stiffness: it has neither stress nor energy, however deformed.
Index slack_material(Model& m, State& s) {
  const Index count = Index(m.material_lambda.size());
  const bool known = count > 0 && on_host(m.material_mu)[count - 1] == 0;
  const Index row = known ? count - 1 : count;
  // all of them: a stage that changes some gives those for the materials of the case alone
  describe_model(m, s, [&](const ColumnInfo& info, auto& column) {
    if (info.rows == "materials" && column.size() > 0)
      column.resize(std::size_t(row + 1) * info.numbers);
  });
  return row;
}

/// is_out(item): is an item of a set out, or a side of a pair?
template <class Set>
auto items_out(const Model& m, const State& s, const Set& set) {
  return [for_each_node = nodes_of(m, set), out = on_host(s.nodes.out)](Index item) {
    bool any = false;
    for_each_node(item, [&](Index node) { any |= out[node] != 0; });
    return any;
  };
}

/// Undo the part of the coming half step in the last sample.
void stop_nodes(NodeState& n, const std::vector<Index>& which) {
  const auto sample = on_host(n.sample), work_external = on_host(n.work_external);
  const auto work_damping = on_host(n.work_damping), step_change = on_host(n.step_change);
  const auto unbalance = on_host(n.unbalance);
  for (const std::size_t i : which) {
    work_external[i] -= sample[4 * i + 1];
    work_damping[i] -= sample[4 * i + 2];
    step_change[i] -= sample[4 * i + 3];
    unbalance[i] = 0;
  }
  const auto radiated = on_host(n.radiated), radiated_sample = on_host(n.radiated_sample);
  for (const std::size_t i : which)
    if (radiated.size() > 0) radiated[i] -= std::exchange(radiated_sample[i], 0);
  const auto zero = [&](Column<Real>& rows, std::size_t width, std::size_t from) {
    const auto numbers = on_host(rows);
    for (const std::size_t i : which)
      for (std::size_t k = from; numbers.size() > 0 && k < width; ++k) numbers[width * i + k] = 0;
  };
  for (Column<Real>* rows : {&n.force, &n.reaction, &n.sample, &n.damping_force}) zero(*rows, 4, 0);
  zero(n.motion, 8, 4);
  zero(n.relax, 8, 0);
  if (n.relax.size() == 0) return;
  const auto relax = on_host(n.relax);
  for (const std::size_t i : which) relax[8 * i + 3] = 1;
}

void unload(State&, const ElementSet& e, ElementState& es, const std::vector<Index>& which,
            OnHost<Flag>) {
  const auto energy = on_host(es.energy), point_stress = on_host(es.point_stress);
  for (const Index i : which) {
    energy[i] = 0;
    for (std::size_t k = 0; k < point_stress.size() / e.stride; ++k)
      point_stress[k * e.stride + i] = 0;
  }
}

/// The faces of a pair become exposed; removed ones leave at the end.
void unload(State& s, const PairSet& p, PairState& ps, const std::vector<Index>& which,
            OnHost<Flag> open) {
  const auto is_active = activity(ps);
  const auto faces = on_host(p.faces);
  for (const Index i : which)
    for (const Index side : {0, 1})
      if (is_active(i)) open[faces[2 * i + side]] = 1;
  const auto status = on_host(ps.status);
  const auto stored = on_host(ps.stored), jump = on_host(ps.jump);
  const auto jump_at_break = on_host(ps.jump_at_break);
  const auto force = on_host(s.corner_force);
  for (const Index i : which) {
    status[i] = Flag(PairStatus::released);
    corner_rows_of(p)(i, [&](Index row) {  // kernels leave them as they are, see BondEnds
      for (Index k = 0; k < 4; ++k) force[4 * std::size_t(row) + k] = 0;
    });
    stored[i] = 0;
    jump[i] = 0;
    jump_at_break[i] = -1;
  }
}

template <ModuleData Given>
void unload(State& s, const Given& given, auto& state, const std::vector<Index>& which,
            OnHost<Flag>) {
  Given::Module::take_out(given, state, which, on_host(s.nodes.out).data());
}

}  // namespace

Real stored_energy(const Model& m, const State& s) {
  const Energies e = energies(m, s);
  return e.terms[energy_term("kinetic")] + e.terms[energy_term("strain")] +
         e.terms[energy_term("contact")];
}

void change_exposed(const Model& m, State& s, const Column<Flag>& open) {
  const auto opens = on_host(open);
  const auto exposed_face = on_host(s.search.exposed_face);
  const auto edge_friction = on_host(s.edges.friction), edge_dashpot = on_host(s.edges.dashpot);
  const auto friction = on_host(s.springs.friction), dashpot = on_host(s.springs.dashpot);
  for (std::size_t x = 0; x < exposed_face.size(); ++x) {
    if (opens[exposed_face[x]]) continue;
    s.taken_out_friction += edge_friction[x];
    s.taken_out_dashpot += edge_dashpot[x];
    for (std::size_t slot = 4 * x; slot < 4 * x + 4; ++slot) {
      s.taken_out_friction += friction[slot];
      s.taken_out_dashpot += dashpot[slot];
    }
  }
  renew_exposed(m, s, open);
}

void take_out(Model& m, State& s, const Flag* leaves) {
  const Real before = stored_energy(m, s);
  s.nodes.out.resize(m.node_count);
  const auto out = on_host(s.nodes.out);
  std::vector<Index> stop;
  for (Index i = 0; i < m.node_count; ++i) {
    if (!leaves[i] || out[i]) continue;
    out[i] = 1;
    stop.push_back(i);
  }
  stop_nodes(s.nodes, stop);
  Column<Flag> open = open_faces(s);
  const auto opens = on_host(open);
  for_each_set(m, s, [&](auto, const auto& set, auto& state) {
    const auto is_out = items_out(m, s, set);
    std::vector<Index> which;
    for (Index i = 0; i < set.count; ++i)
      if (is_out(i)) which.push_back(i);
    unload(s, set, state, which, opens);
  });
  const auto face_nodes = on_host(m.face_nodes);
  for (Index f = 0; f < m.face_count; ++f)
    if (out[face_nodes[4 * f]]) opens[f] = 0;
  change_exposed(m, s, open);
  s.taken_out += before - stored_energy(m, s);
  hold_taken_out(m, s);
  list_pairs_of_exposed(m, s, {.everything_awake = true}, true);
}

void hold_taken_out(Model& m, State& s) {
  if (s.nodes.out.size() == 0) return;
  const Index support = holding_support(m), slack = slack_material(m, s);
  const auto out = on_host(s.nodes.out);
  const auto support_row = on_host(m.support), mass_row = on_host(m.mass_row_first);
  const auto load_first = on_host(m.load_first);
  const auto gravity_mass = on_host(m.gravity_mass), load_force = on_host(m.load_force);
  for (Index i = 0; i < m.node_count; ++i) {
    if (!out[i]) continue;
    support_row[i] = support;
    mass_row[i] = -1;
    gravity_mass[i] = 0;
    for (Index k = 4 * load_first[i]; k < 4 * load_first[i + 1]; ++k) load_force[k] = 0;
  }
  for_each_element_set(m, s, [&](auto, ElementSet& e, const ElementState&) {
    const auto is_out = items_out(m, s, e);
    const auto material = on_host(e.material);
    const auto hourglass = on_host(e.hourglass);
    for (Index i = 0; i < e.count; ++i) {
      if (!is_out(i)) continue;
      material[i] = slack;
      for (std::size_t k = 0; k < hourglass.size() / e.stride; ++k) hourglass[k * e.stride + i] = 0;
    }
  });
}

}  // namespace cdem
