// change_bolts.cpp - see change_bolts.hpp.
#include "core/run/change_bolts.hpp"

#include "core/contact/force/stiffness_bound.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/corner_lists.hpp"
#include "core/nodes/sleep.hpp"
#include "core/nodes/time_step.hpp"

namespace cdem {

namespace {

/// Lists and stable step that follow from the bolts that act.
void renew_lists(const Model& m, State& s) {
  list_corners(m, s);
  sum_stiffness(m, s);
  list_awake_nodes(m, s);
  renew_step(m, s);
}

}  // namespace

void install_bolts(const Model& m, State& s, const Flag* which) {
  for (Index i = 0; i < m.bolts.count; ++i)
    if (which[i] && s.bolts.phase[i] == Flag(BoltPhase::waiting))
      s.bolts.phase[i] = Flag(BoltPhase::placed);
  renew_lists(m, s);
}

void remove_bolts(const Model& m, State& s, const Flag* which) {
  BoltState& bs = s.bolts;
  for (Index i = 0; i < m.bolts.count; ++i) {
    if (!which[i]) continue;
    bs.phase[i] = Flag(BoltPhase::removed);
    bs.lost[i] += bs.stored[i];
    bs.stored[i] = 0;
    for (Index n = m.bolts.first[i]; n < m.bolts.first[i + 1]; ++n)
      bs.grout_force[n] = bs.end_force[n] = bs.axial_force[n] = 0;
    for (Index c = 4 * m.bolts.crossing_first[i]; c < 4 * m.bolts.crossing_first[i + 1]; ++c)
      bs.dowel_force[c] = 0;
  }
  renew_lists(m, s);
}

}  // namespace cdem
