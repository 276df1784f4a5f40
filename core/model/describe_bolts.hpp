// describe_bolts.hpp - the arrays of bolts: part of describe_model.hpp and describe_state.hpp.
#pragma once

#include "core/model/model.hpp"
#include "core/model/row_kinds.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Bolts: part of `describe_model`.
template <class Visit>
void describe_set(const char* rows, BoltSet& b, Visit&& given) {
  given({.name = "bolts.first",
         .meaning = "nodes of a bolt",
         .rows = rows,
         .layout = Layout::starts,
         .refers_to = {"bolt_nodes"}},
        b.first);
  given({.name = "bolts.crossing_first",
         .meaning = "crossings of a bolt with joints",
         .rows = rows,
         .layout = Layout::starts,
         .refers_to = {"bolt_crossings"}},
        b.crossing_first);
  given({.name = "bolts.properties",
         .unit = "N, N, N, 1, N",
         .meaning = "E A, yield in tension and in compression, strain at rupture, pretension",
         .rows = rows,
         .numbers = 5},
        b.properties);
  given({.name = "bolts.waits", .meaning = "1: not installed at the start", .rows = rows}, b.waits);
  given({.name = "bolts.grout",
         .unit = "N/m, N",
         .meaning = "stiffness and limit of the grout at a node",
         .rows = "bolt_nodes",
         .numbers = 2},
        b.grout);
  given({.name = "bolts.end",
         .unit = "N/m, N",
         .meaning = "the same of the plate or the anchor",
         .rows = "bolt_nodes",
         .numbers = 2},
        b.end);
  given({.name = "bolts.crossing_bar",
         .meaning = "bar that leads across a joint, by its first node",
         .rows = "bolt_crossings",
         .refers_to = {"bolt_nodes"}},
        b.crossing_bar);
  given({.name = "bolts.dowel",
         .unit = "N/m, N",
         .meaning = "stiffness and limit of the dowel",
         .rows = "bolt_crossings",
         .numbers = 2},
        b.dowel);
  given({.name = "bolts.hosts",
         .meaning = "nodes of the rock that a point lies between; -1: none",
         .rows = "bolt_points",
         .numbers = 8,
         .refers_to = {"nodes"}},
        b.hosts);
  given({.name = "bolts.weights",
         .meaning = "weights of a point on them",
         .rows = "bolt_points",
         .numbers = 8},
        b.weights);
  given({.name = "bolts.stiffness",
         .unit = "N/m",
         .meaning = "what a point puts on the rock at most",
         .rows = "bolt_points"},
        b.stiffness);
}

/// Nodes of bolts: part of `describe_state`.
template <class Stored>
void describe_bolt_nodes(BoltState& b, Stored&& stored) {
  const auto of_node = [&](const char* name, const char* unit, const char* meaning, auto& column) {
    stored({.name = name, .unit = unit, .meaning = meaning, .rows = "bolt_nodes"}, column);
  };
  of_node("bolts.slip", "m", "slip of the bolt against the rock, towards the toe", b.slip);
  of_node("bolts.grout_free", "m", "slip at which the grout is free of force", b.grout_free);
  of_node("bolts.end_free", "m", "the same of the plate or the anchor", b.end_free);
  of_node("bolts.grout_force", "N", "force of the grout on the rock", b.grout_force);
  of_node("bolts.end_force", "N", "force of the plate or the anchor on the rock", b.end_force);
  of_node("bolts.length", "m", "length of the bar to the next node when it was installed",
          b.length);
  of_node("bolts.bar_free", "m", "extension at which the bar is free of force", b.bar_free);
  of_node("bolts.axial_force", "N", "force of the bar, tension positive", b.axial_force);
  of_node("bolts.grout_state", "1", "0: holds, 1, 2: slips towards the toe, the head",
          b.grout_state);
  of_node("bolts.end_state", "1", "the same of the plate or the anchor", b.end_state);
  of_node("bolts.bar_state", "1", "0: elastic, 1, 2: yields in tension, compression", b.bar_state);
  of_node("bolts.bar_broken", "1", "0: whole, 1: ruptured, 2: cut by digging", b.bar_broken);
  of_node("bolts.grout_lost", "1", "1: its rock was dug out", b.grout_lost);
}

/// Bolts: part of `describe_state`.
template <class Stored, class Rebuilt>
void describe_set(const char* rows, const BoltSet&, BoltState& b, Stored&& stored,
                  Rebuilt&& rebuilt) {
  stored({.name = "bolts.phase",
          .meaning = "0: waits, 1: is placed in the next step, 2: acts, 3: removed",
          .rows = rows},
         b.phase);
  describe_bolt_nodes(b, stored);
  const auto of_crossing = [&](const char* name, const char* unit, const char* meaning,
                               Column<Real>& numbers) {
    stored({.name = name, .unit = unit, .meaning = meaning, .rows = "bolt_crossings", .numbers = 4},
           numbers);
  };
  of_crossing("bolts.dowel_free", "m", "shift at which the dowel is free, and a pad", b.dowel_free);
  of_crossing("bolts.dowel_force", "N", "its force on the block that the bolt leaves, and a pad",
              b.dowel_force);
  const auto of_bolt = [&](const char* name, const char* meaning, Column<Real>& numbers) {
    stored({.name = name, .unit = "J", .meaning = meaning, .rows = rows}, numbers);
  };
  of_bolt("bolts.stored", "elastic energy", b.stored);
  of_bolt("bolts.lost", "work of slip, yield and rupture", b.lost);
  of_bolt("bolts.jacked", "work of the jack that gave it its pretension", b.jacked);
  rebuilt(
      "update_bolt_forces",
      {.name = "bolts.scratch",
       .unit = "m, and of the solver",
       .meaning = "place of a node x y z, length of its bar, three numbers of the solver, a pad",
       .rows = "bolt_nodes",
       .numbers = 8},
      b.scratch);
  rebuilt("find_awake",
          {.name = "bolts.awake",
           .meaning = "blocks of bolts that hold rock that can move; all are computed",
           .refers_to = {blocks_of(rows)}},
          b.awake);
}

}  // namespace cdem
