// applied.cpp - see applied.hpp.
#include "core/nodes/applied.hpp"

#include "core/base/parallel.hpp"
#include "core/model/phase_timer.hpp"
#include "core/nodes/sum_applied.hpp"

namespace cdem {

namespace {

void sum_on_nodes(const Model& m, State& s, Queue q, AppliedForces& of, Real dt) {
  const PhaseTimer timer(s, Phase::node);
  of.sum.resize(4 * std::size_t(m.node_count));  // a checkpoint may come without
  of.work.resize(m.node_count);
  for_each_item(q, m.node_count,
                SumApplied{.nodes = {s.nodes.motion.data()},
                           .first = of.first.data(),
                           .row = of.row.data(),
                           .rows = {of.rows.data()},
                           .out = s.nodes.out.size() > 0 ? s.nodes.out.data() : nullptr,
                           .dt = dt,
                           .force = of.sum.data(),
                           .work = of.work.data()});
}

}  // namespace

void add_applied(const Model& m, State& s) {
  const Queue q;
  bool first = true;
  if (s.nodes.applied.size() == 0) return;
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    const Column<Real>& force = applied_of<Module>(s).sum;
    if (force.size() == 0) return;
    for_each_item(q, m.node_count,
                  AddApplied{.force = force.data(), .first = first, .sum = s.nodes.applied.data()});
    first = false;
  });
}

void act_of_modules(const Model& m, State& s, Queue q, Stage stage) {
  Modules::for_each([&]<class Module>() {
    if (Module::stage != stage) return;
    Module::act(m, s, q);
    if constexpr (Module::port == Port::applied)
      if (Module::is_there(given_of<Module>(m)))
        sum_on_nodes(m, s, q, applied_of<Module>(s), s.step > 0 ? s.dt_last : 0);
  });
  if (stage == Stage::after_contacts) add_applied(m, s);
}

std::vector<Real> change_applied(const Model& m, State& s) {
  std::vector<Real> change;
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    if (!Module::is_there(given_of<Module>(m))) return;
    AppliedForces& of = applied_of<Module>(s);
    const std::vector<Real> before = fetch(of.sum);
    Module::act(m, s, {});
    sum_on_nodes(m, s, {}, of, 0);
    const auto now = on_host(of.sum);
    change.resize(before.size());
    for (std::size_t k = 0; k < change.size(); ++k) change[k] += now[k] - before[k];
  });
  add_applied(m, s);
  return change;
}

}  // namespace cdem
