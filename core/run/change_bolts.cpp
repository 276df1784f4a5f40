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
  const auto phase = on_host(s.bolts.phase);
  for (Index i = 0; i < m.bolts.count; ++i)
    if (which[i] && phase[i] == Flag(BoltPhase::waiting)) phase[i] = Flag(BoltPhase::placed);
  renew_lists(m, s);
}

void remove_bolts(const Model& m, State& s, const Flag* which) {
  BoltState& bs = s.bolts;
  const auto first = on_host(m.bolts.first), crossing_first = on_host(m.bolts.crossing_first);
  const auto phase = on_host(bs.phase);
  const auto lost = on_host(bs.lost), stored = on_host(bs.stored);
  const auto grout_force = on_host(bs.grout_force), end_force = on_host(bs.end_force);
  const auto axial_force = on_host(bs.axial_force), dowel_force = on_host(bs.dowel_force);
  for (Index i = 0; i < m.bolts.count; ++i) {
    if (!which[i]) continue;
    phase[i] = Flag(BoltPhase::removed);
    lost[i] += stored[i];
    stored[i] = 0;
    for (Index n = first[i]; n < first[i + 1]; ++n)
      grout_force[n] = end_force[n] = axial_force[n] = 0;
    for (Index c = 4 * crossing_first[i]; c < 4 * crossing_first[i + 1]; ++c) dowel_force[c] = 0;
  }
  renew_lists(m, s);
}

}  // namespace cdem
