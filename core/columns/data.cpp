// data.cpp - see data.hpp.
#include "core/columns/data.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/columns/side.hpp"
#include "core/model/model.hpp"
#include "core/model/phase_timer.hpp"
#include "core/model/state.hpp"

namespace cdem {

namespace {

/// Room for the state; a checkpoint may come without. Branches begin without strain.
void size(const Model& m, const ColumnSet& g, ColumnState& s) {
  for (Column<Real>* column : {&s.displacement, &s.before, &s.after})
    column->resize(4 * g.mass.size());
  s.branch.resize(m.maxwell.any() ? 4 * BranchStep::count * g.mass.size() : 0);
  s.made.resize(g.count, -1);
}

Layers layers_of(const Model& m, const cdem::State& all, const ColumnSet& g, ColumnState& s) {
  return {.rows = g.layer.data(),
          .bond = g.bond.data(),
          .rock_time = m.damping_time + m.stiffness_damping * all.dt,
          .bond_time = m.damping_time,
          .maxwell = {m.maxwell, all.dt_last},
          .motion = {.displacement = s.displacement.data(),
                     .before = s.before.data(),
                     .after = s.after.data(),
                     .branch = s.branch.size() > 0 ? s.branch.data() : nullptr}};
}

void advance(const Model& m, cdem::State& all, Queue q) {
  const ColumnSet& g = given_of<Columns>(m);
  ColumnState& s = state_of<Columns>(all);
  for_each_item(q, g.count,
                AdvanceColumns{.level_first = g.level_first.data(),
                               .layers = layers_of(m, all, g, s),
                               .mass = g.mass.data(),
                               .foot = g.foot.data(),
                               .input_first = g.input_first.data(),
                               .input_curve = g.input_curve.data(),
                               .input = g.input.data(),
                               .curve_value = all.load_factor.data(),
                               .curve_velocity = all.velocity_factor.data(),
                               .acts = g.acts.data(),
                               .mass_damping = m.damping.mass,
                               .dt_before = all.dt_last,
                               .dt = all.dt,
                               .step = Index(all.step),
                               .made = s.made.data()});
}

}  // namespace

std::vector<Index> Columns::row_nodes(const Model& m, const cdem::State&) {
  const auto node = on_host(given_of<Columns>(m).node);
  return {node.begin(), node.end()};
}

void Columns::start(const Model& m, cdem::State& all) {
  size(m, given_of<Columns>(m), state_of<Columns>(all));
}

Real Columns::frequency_squared(const Given& g, Real stiffer) {
  const auto first = on_host(g.level_first);
  const auto layer = on_host(g.layer), mass = on_host(g.mass);
  const auto acts = on_host(g.acts), bond = on_host(g.bond);
  Real highest = 0;
  for (Index c = 0; c < g.count; ++c) {
    if (!acts[c]) continue;
    Real below = 0;
    for (Index l = first[c]; l < first[c + 1]; ++l) {
      const Real* own = layer.data() + 4 * std::size_t(l);
      const Real more = bond[l] ? 1 : stiffer;
      const Real above = l + 1 < first[c + 1] ? more * own[1] / own[0] : 0;
      highest = std::max(highest, 2 * (below + above) / mass[l]);
      below = above;
    }
  }
  return highest;
}

void Columns::act(const Model& m, cdem::State& all, Queue q) {
  const ColumnSet& g = given_of<Columns>(m);
  if (!is_there(g)) return;
  const PhaseTimer timer(all, Phase::node);
  ColumnState& s = state_of<Columns>(all);
  size(m, g, s);
  advance(m, all, q);
  for_each_item(q, g.side_count,
                SideForces{.layer_first = g.layer_first.data(),
                           .layer = g.side_layer.data(),
                           .area = g.area.data(),
                           .level = g.level.data(),
                           .part = g.part.data(),
                           .dashpot = g.dashpot.data(),
                           .layers = layers_of(m, all, g, s),
                           .out = {applied_of<Columns>(all).rows.data()}});
}

}  // namespace cdem
