// run.cpp - see run.hpp.
#include "core/run/run.hpp"

#include <iterator>

#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/force/force.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/pair_list/rebuild.hpp"
#include "core/diagnostics/energy.hpp"
#include "core/diagnostics/unbalance.hpp"
#include "core/elements/nodal_mean.hpp"
#include "core/model/rebuilds.hpp"
#include "core/nodes/applied.hpp"
#include "core/nodes/corner_lists.hpp"
#include "core/nodes/curves.hpp"
#include "core/nodes/ground.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/nodes.hpp"
#include "core/nodes/sleep.hpp"
#include "core/nodes/time_step.hpp"
#include "core/ranks/ranks.hpp"
#include "core/step.hpp"

namespace cdem {

namespace {

struct AfterResume {
  RebuiltBy name;
  void (*rebuild)(const Model&, State&);
};

/// In the order of `rebuilds`.
constexpr AfterResume after_resume[] = {
    {"list_nodal_means", list_nodal_means},
    {"find_loads_and_supports", find_loads_and_supports},
    {"list_exposed", list_exposed},
    {"list_corners", list_corners},
    {"list_ground", list_ground},
    {"list_lumped", list_lumped},
    {"place_predicted_nodes", place_predicted_nodes},
    {"add_applied", add_applied},
    {"find_awake", find_awake},
};

consteval bool is_complete() {
  std::size_t next = 0;
  for (std::size_t place = 0; place < std::size(rebuilds); ++place) {
    if (rebuilds[place].made != Made::after_resume) continue;
    if (next == std::size(after_resume) || after_resume[next++].name.place != place) return false;
  }
  return next == std::size(after_resume);
}
static_assert(is_complete(), "prepare() calls all functions of Made::after_resume, in their order");

}  // namespace

void prepare(const Model& m, State& s) {
  if (s.built_step < 0) {
    list_nodal_means(m, s);
    find_loads_and_supports(m, s);
    list_ground(m, s);
    rebuild_pair_list(m, s, {.everything_awake = true});
    s.dt_last = s.dt;
    return;
  }
  const std::size_t exposed = s.search.exposed_face.size();
  s.face_geometry.resize(8 * exposed);
  s.contact_force.resize(16 * exposed);
  for (const AfterResume& one : after_resume) one.rebuild(m, s);
  s.share.pairs_elsewhere = s.share.exchange && any_rank(s, names_pairs(s.search.outer));
}

namespace {

/// Where in a run a step is.
struct Place {
  bool first;      // of the run: loads, supports or strengths may have been changed
  bool last;       // of the run, as far as is known before it
  bool scheduled;  // for a check, whatever the split into runs
};

Place place_of(const State& s, const Goal& goal, std::int64_t number) {
  return {.first = number == 1,
          .last = number == goal.steps || s.time + s.dt >= goal.end_time,
          .scheduled = s.step % goal.check_interval == 0};
}

/// Sampling changes no motion: where nothing asks for a sample, it need not be taken.
StepPlan plan_step(const Model& m, const State& s, const Goal& goal, const Place& place) {
  const bool sample = place.last || !s.ledger_started || goal.relaxation == Relaxation::kinetic ||
                      (place.scheduled && goal.unbalance_limit > 0);
  return {.sample = sample,
          .everything_awake = place.first,
          .stop_motion = s.stop_due,
          .fuse_blocks = !sample && !place.first && !s.stop_due && !damps_nodes(m, s)};
}

void begin_run(State& s, const Goal& goal) {
  if (goal.relaxation != Relaxation::adaptive) s.relax_damping = 0;
  if (goal.relaxation != Relaxation::kinetic) s.stop_due = false;
}

void end_step(const Model& m, State& s, const Goal& goal, const StepPlan& plan) {
  if (plan.sample && !s.ledger_started) open_ledger(m, s);
  if (goal.relaxation == Relaxation::kinetic) relax_kinetically(m, s);
  if (goal.relaxation == Relaxation::adaptive) relax_adaptively(m, s);
}

/// Why the run ends after this step, or `steps_done` where it may go on.
Report report_of(const Model& m, const State& s, const Goal& goal, const Place& place) {
  if (m.check_search && any_rank(s, s.missed > 0))
    return {Outcome::missed_contact, -1, Real(s.missed)};
  if (!place.last && !place.scheduled) return {};
  const Report health = check_health(m, s);
  if (health.outcome != Outcome::steps_done) return health;
  const bool asks = place.scheduled && goal.unbalance_limit > 0;  // also where the time is up
  if (asks && unbalance_ratio(m, s) < goal.unbalance_limit) {
    return {Outcome::converged, -1, s.time};
  }
  if (s.time >= goal.end_time) return {Outcome::time_reached, -1, s.time};
  return {};
}

/// Ranks: may the coming rebuild list pairs with elements that are not here?
bool ghosts_are_due(const Model& m, State& s) {
  return s.share.exchange && foresee_rebuild(m, s) && leaves_fence(m, s);
}

Report take_steps(const Model& m, State& s, const Goal& goal) {
  for (std::int64_t n = 1; n <= goal.steps; ++n) {
    if (ghosts_are_due(m, s)) return {Outcome::ghosts_due, -1, 0};
    if (goal.relaxation == Relaxation::adaptive) scale_masses_if_due(m, s);
    const Place place = place_of(s, goal, n);
    const StepPlan plan = plan_step(m, s, goal, place);
    step(m, s, {}, plan);
    end_step(m, s, goal, plan);
    const Report report = report_of(m, s, goal, place);
    if (report.outcome != Outcome::steps_done) return report;
  }
  return {};
}

}  // namespace

Report run(const Model& m, State& s, const Goal& goal) {
  const RunOnDevice on_device;
  begin_run(s, goal);
  const Report report = take_steps(m, s, goal);
  s.search.asked_step = s.search.decided_step = -1;  // something may move nodes before the next run
  s.search.outer.skin_exceeded = false;              // what a resumed run does not know, either
  fit_contacts_by_target(s);
  finish({});  // Python may have views of arrays
  return report;
}

}  // namespace cdem
