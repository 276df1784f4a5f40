// describe_bolts.hpp - the arrays of bolts: part of describe_model.hpp.
#pragma once

#include "core/model/column_info.hpp"
#include "core/model/model.hpp"

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

}  // namespace cdem
