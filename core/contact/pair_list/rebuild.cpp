// rebuild.cpp - see rebuild.hpp.
#include "core/contact/pair_list/rebuild.hpp"

#include "core/bonds/bonded_surface.hpp"
#include "core/bonds/release.hpp"
#include "core/bonds/transfer_to_contact.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/force/stiffness_bound.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/pair_list/outer_list.hpp"
#include "core/model/phase_timer.hpp"
#include "core/nodes/corner_lists.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/sleep.hpp"
#include "core/nodes/time_step.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

void ask_what_is_due(const Model& m, State& s) {
  const PhaseTimer timer(s, Phase::rebuild);
  SearchState& search = s.search;
  search.asked_step = s.step;
  search.due.set({}, {});
  Due* const due = search.due.data();
  if (m.rebuild_interval == 0 && s.built_step >= 0) {
    ask_if_release_is_due(m, s, &due->release);
    ask_if_skin_is_exceeded(s, search.outer.predicted, search.outer.built_time,
                            search.outer.lookahead_time, &due->outer);
  }
  if (search.inner.known && has_contact_pairs(s))
    ask_if_skin_is_exceeded(s, search.inner.predicted, search.inner.built_time,
                            inner_horizon * search.outer.lookahead_time, &due->inner);
}

namespace {

/// A rebuild is due for all ranks, or for none; pruning is the affair of each.
Due due_of_ranks(const State& s, Due own) {
  if (!s.share.exchange) return own;
  std::int64_t words[] = {own.release, own.outer};
  s.share.exchange->add_up(words, 2);
  own.release = words[0] > 0, own.outer = words[1] > 0;
  return own;
}

bool decides(const Model& m, State& s, const Due& due) {
  if (s.built_step < 0) return true;
  if (m.rebuild_interval > 0) return s.step - s.built_step >= m.rebuild_interval;
  if (due.release != 0) return true;
  return s.search.outer.skin_exceeded = due.outer != 0;
}

}  // namespace

bool pair_list_is_due(const Model& m, State& s) {
  const PhaseTimer timer(s, Phase::rebuild);
  SearchState& search = s.search;
  if (search.decided_step == s.step) {
    search.decided_step = -1;
    return search.rebuild_is_due;
  }
  if (search.asked_step != s.step) ask_what_is_due(m, s);
  const Due due = due_of_ranks(s, search.due.read({}));
  search.asked_step = -1;
  search.inner.skin_exceeded = due.inner != 0;
  search.outer.skin_exceeded = false;
  return decides(m, s, due);
}

bool foresee_rebuild(const Model& m, State& s) {
  s.search.rebuild_is_due = pair_list_is_due(m, s);
  s.search.decided_step = s.step;
  return s.search.rebuild_is_due;
}

void rebuild_pair_list(const Model& m, State& s, const StepPlan& plan) {
  const PhaseTimer timer(s, Phase::rebuild);
  const bool first = s.built_step < 0;
  if (first) {
    s.search.face_exposed.resize(m.face_count, -1);
    renew_exposed(m, s, m.face_initially_exposed);
  }
  const bool released = any_rank(s, release_bonds(m, s)) || first;
  await_contacts(m, s);
  list_pairs_of_exposed(m, s, plan, released);
}

void list_pairs_of_exposed(const Model& m, State& s, const StepPlan& plan, bool released) {
  join_surfaces(m, s, released);
  list_exposed(m, s);
  const Column<Real> stiffest = list_candidates(m, s);
  s.share.pairs_elsewhere = s.share.exchange && any_rank(s, names_pairs(s.search.outer));
  if (released) {
    list_corners(m, s);
    list_lumped(m, s);
  }
  list_contact_corners(m, s);
  sum_bond_stiffness(m, s);
  sum_contact_stiffness(m, s, stiffest);
  if (!plan.everything_awake) list_awake_nodes(m, s);
  s.built_step = s.step;
  ++s.rebuilds;
  renew_step(m, s);  // faces that may now touch call for a shorter step before they do
}

}  // namespace cdem
