// describe_scalars.hpp - the list of the numbers of a state that survive a restart.
#pragma once

#include "core/model/state.hpp"

namespace cdem {

/// Description of a number of the state.
struct ScalarInfo {
  const char* name;
  const char* unit;  // "1" where it has none
  const char* meaning;
};

/// Data of the energy ledger: part of `describe_scalars`.
template <class Visit>
void describe_ledger(State& s, Visit&& visit) {
  visit(
      ScalarInfo{
          .name = "ledger_started", .unit = "1", .meaning = "the energy ledger has been opened"},
      s.ledger_started);
  visit(
      ScalarInfo{
          .name = "energy_start", .unit = "J", .meaning = "energy when the ledger was opened"},
      s.energy_start);
  visit(
      ScalarInfo{
          .name = "energy_scale", .unit = "J", .meaning = "largest term of the ledger so far"},
      s.energy_scale);
  visit(ScalarInfo{.name = "stopped_energy",
                   .unit = "J",
                   .meaning = "energy taken out by kinetic relaxation and changes of mass"},
        s.stopped_energy);
  visit(ScalarInfo{.name = "taken_out", .unit = "J", .meaning = "stored energy of removed blocks"},
        s.taken_out);
  visit(ScalarInfo{.name = "taken_out_friction",
                   .unit = "J",
                   .meaning = "frictional work of contacts on their faces until then"},
        s.taken_out_friction);
  visit(ScalarInfo{.name = "taken_out_dashpot",
                   .unit = "J",
                   .meaning = "work of the dashpots of these contacts"},
        s.taken_out_dashpot);
}

/// Visit every number that a checkpoint keeps.
template <class Visit>
void describe_scalars(State& s, Visit&& visit) {
  visit(ScalarInfo{.name = "time", .unit = "s", .meaning = "simulated time"}, s.time);
  visit(
      ScalarInfo{.name = "loads_time", .unit = "s", .meaning = "time that loads and supports have"},
      s.loads_time);
  visit(ScalarInfo{.name = "dt", .unit = "s", .meaning = "length of the coming step"}, s.dt);
  visit(ScalarInfo{.name = "dt_last", .unit = "s", .meaning = "length of the last step"},
        s.dt_last);
  visit(ScalarInfo{.name = "dt_stable", .unit = "s", .meaning = "step that dt grows towards"},
        s.dt_stable);
  visit(ScalarInfo{.name = "step", .unit = "1", .meaning = "steps done"}, s.step);
  visit(ScalarInfo{.name = "rebuilds", .unit = "1", .meaning = "outer pair lists made so far"},
        s.rebuilds);
  visit(ScalarInfo{.name = "built_step",
                   .unit = "1",
                   .meaning = "step before which the outer pair list was made, or -1"},
        s.built_step);
  visit(ScalarInfo{.name = "built_time", .unit = "s", .meaning = "time at which it was made"},
        s.search.outer.built_time);
  visit(ScalarInfo{.name = "lookahead_time",
                   .unit = "s",
                   .meaning = "how long the outer pair list holds at most"},
        s.search.outer.lookahead_time);
  visit(ScalarInfo{.name = "least_skin",
                   .unit = "1",
                   .meaning = "least skin of a node, in parts of the smallest L of its faces"},
        s.search.outer.least_skin);
  describe_ledger(s, visit);
  const auto relief = [&](const char* name, const char* unit, const char* meaning, Real& number) {
    visit(ScalarInfo{.name = name, .unit = unit, .meaning = meaning}, number);
  };
  relief("relief_begin", "s", "time at which the release of removed blocks begins", s.relief.begin);
  relief("relief_end", "s", "time at which the release ends", s.relief.end);
  relief("relief_from", "1", "remaining fraction of the forces at the former", s.relief.from);
  relief("relief_to", "1", "remaining fraction at the latter", s.relief.to);
  visit(ScalarInfo{.name = "kinetic_peak",
                   .unit = "J",
                   .meaning = "peak of the kinetic energy since all motion was last stopped"},
        s.kinetic_peak);
  visit(ScalarInfo{.name = "stop_due",
                   .unit = "1",
                   .meaning = "the next step stops all motion (kinetic relaxation)"},
        s.stop_due);
  visit(ScalarInfo{.name = "damped",
                   .unit = "1",
                   .meaning = "the last step damped nodes: node.damping_force is of it"},
        s.nodes.damped);
  visit(ScalarInfo{.name = "relax_damping",
                   .unit = "1/s",
                   .meaning = "mass damping that adaptive relaxation has found"},
        s.relax_damping);
}

}  // namespace cdem
