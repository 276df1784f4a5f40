// views.hpp - the kernel's view of bolts in model and state.
#pragma once

#include "core/bolts/solve_bolts.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline BoltNodeColumns bolt_node_columns(const BoltSet& b, BoltState& bs) {
  return {.grout = b.grout.data(),
          .end = b.end.data(),
          .grout_lost = bs.grout_lost.data(),
          .slip = bs.slip.data(),
          .grout_free = bs.grout_free.data(),
          .end_free = bs.end_free.data(),
          .grout_force = bs.grout_force.data(),
          .end_force = bs.end_force.data(),
          .length = bs.length.data(),
          .bar_free = bs.bar_free.data(),
          .axial_force = bs.axial_force.data(),
          .grout_state = bs.grout_state.data(),
          .end_state = bs.end_state.data(),
          .bar_state = bs.bar_state.data(),
          .bar_broken = bs.bar_broken.data(),
          .scratch = bs.scratch.data()};
}

inline SolveBolt bolt_solver(const Model& m, State& s) {
  const BoltSet& b = given_of<Bolts>(m);
  BoltState& bs = state_of<Bolts>(s);
  return {.nodes = {s.nodes.motion.data()},
          .first = b.first.data(),
          .crossing_first = b.crossing_first.data(),
          .node_count = bolt_node_count(b),
          .hosts = b.hosts.data(),
          .weights = b.weights.data(),
          .properties = b.properties.data(),
          .columns = bolt_node_columns(b, bs),
          .dowels = {.bar = b.crossing_bar.data(),
                     .dowel = b.dowel.data(),
                     .free_jump = bs.dowel_free.data(),
                     .force = bs.dowel_force.data()},
          .phase = bs.phase.data(),
          .stored = bs.stored.data(),
          .lost = bs.lost.data(),
          .jacked = bs.jacked.data(),
          .corner_force = s.corner_force.data() + std::size_t(b.corner_first) * 4};
}

}  // namespace cdem
