// rest.cpp - see rest.hpp.
#include "core/rest/rest.hpp"

#include <algorithm>
#include <memory>

#include "core/base/primitives.hpp"
#include "core/contact/force/force.hpp"
#include "core/diagnostics/unbalance.hpp"
#include "core/elements/report.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/nodes.hpp"
#include "core/nodes/views.hpp"
#include "core/rest/conjugate_gradients.hpp"
#include "core/rest/moved_node.hpp"
#include "core/rest/tangent.hpp"
#include "core/step.hpp"

namespace cdem {

namespace {

constexpr int most_rounds = 12;
// Times the unbalance of the start: beyond it blocks have run into others. The first round of a
// slender beam turns its end without shortening it, so it comes out stretched: 30 are too few.
constexpr Real astray = 3000;
constexpr Real part_of_round = 1e-3;  // to which a round brings the residual of its linear system

/// While one lives nothing depends on velocities, for these are those of a jump.
class NoDamping {
 public:
  explicit NoDamping(Model& m, State& s)
      : model_(m),
        nodes_(m.damping),
        elements_(m.stiffness_damping),
        time_(m.damping_time),
        contacts_(m.contact_damping) {
    m.damping = {0, 0};
    m.stiffness_damping = m.damping_time = m.contact_damping = 0;
    s.relax_damping = 0;
  }
  NoDamping(const NoDamping&) = delete;
  NoDamping& operator=(const NoDamping&) = delete;
  ~NoDamping() {
    model_.damping = nodes_;
    model_.stiffness_damping = elements_;
    model_.damping_time = time_;
    model_.contact_damping = contacts_;
  }

 private:
  Model& model_;
  NodeDamping nodes_;
  Real elements_, time_, contacts_;
};

/// The true forces where the nodes are now, and their sums. Returns the unbalance.
Real find_forces(const Model& m, State& s, Queue q) {
  s.search.outer.skin_exceeded = true;  // the nodes may have moved far
  const StepPlan plan{.sample = true, .everything_awake = true};
  update_forces(m, s, q, plan);
  fit_contacts_by_target(s);
  sum_forces(m, s, q, plan);
  return unbalance_ratio(m, s);
}

/// Moves the nodes by what a linear system says, with the stiffness of when it was made; none where
/// nothing that may move is held.
class Newton {
 public:
  Newton(Model& m, State& s) : model_(&m), state_(&s) {
    const Transfer transfer;
    NodeSystem tangent = tangent_of(m, s);
    if (std::count(tangent.free.begin(), tangent.free.end(), 1) == 0) return;
    free_.assign(tangent.free);
    inverse_ = std::make_unique<Multigrid>(std::move(tangent));
  }

  /// Returns the iterations of the linear system; 0, or -1 where it has no answer: nothing moves.
  int move(Queue q, int most_iterations, Real& unbalance) {
    if (!inverse_) return 0;
    const Model& m = *model_;
    State& s = *state_;
    before_.renew(3 * std::size_t(m.node_count));
    vectors_.r.renew(before_.size());
    for (Real* out : {before_.data(), vectors_.r.data()})
      for_each_item(q, m.node_count, UnbalancedForce{s.nodes.force.data(), free_.data(), out});
    const int iterations =
        solve_by_gradients(q, *inverse_, part_of_round, most_iterations, vectors_);
    if (iterations <= 0) return iterations;
    for_each_item(q, m.node_count,
                  MoveToRest{.way = vectors_.x.data(),
                             .loads = load_columns(m, s),
                             .dt = s.dt_last,
                             .motion = s.nodes.motion.data(),
                             .work_external = s.nodes.work_external.data()});
    unbalance = find_forces(m, s, q);
    for_each_item(q, m.node_count,
                  StopAtRest{.way = vectors_.x.data(),
                             .before = before_.data(),
                             .force = s.nodes.force.data(),
                             .free = free_.data(),
                             .motion = s.nodes.motion.data(),
                             .work_damping = s.nodes.work_damping.data()});
    return iterations;
  }

 private:
  Model* model_;
  State* state_;
  Column<Flag> free_;
  std::unique_ptr<Multigrid> inverse_;
  GradientVectors vectors_;
  Column<Real> before_;
};

}  // namespace

RestFound solve_for_rest(Model& m, State& s, Real limit, int most_iterations) {
  const RunOnDevice on_device;
  const Queue q;
  RestFound found;
  {
    const NoDamping none(m, s);
    if (s.dt_last == 0) s.dt_last = s.dt;
    find_forces(m, s, q);
    stop_motion(m, s);
    s.dt_last = s.dt;
    found.before = found.after = unbalance_ratio(m, s);
    if (!(found.before > limit)) return found;
    Newton newton(m, s);
    for (int slow = 0; found.rounds < most_rounds && found.after > limit && slow < 2;) {
      Real unbalance = 0;
      const int iterations = newton.move(q, most_iterations, unbalance);
      if (iterations <= 0) break;
      ++found.rounds;
      found.iterations += iterations;
      const Real ratio = unbalance / found.after;
      found.after = unbalance;
      if (!(unbalance < astray * found.before)) break;
      slow = ratio < 0.5 ? 0 : slow + 1;  // the first round may turn rock too far
      if (ratio > 0.1 && slow < 2) newton = Newton(m, s);
    }
  }
  // what is sampled is that of rest
  set_all(q, Index(s.nodes.sample.size()), s.nodes.sample.data(), 0.0);
  report_elements(m, s, q);
  finish(q);
  change_mass(m, s, m.lumped);  // a relaxation begins again
  s.dt_last = 0;
  return found;
}

}  // namespace cdem
