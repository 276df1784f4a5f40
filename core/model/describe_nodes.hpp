// describe_nodes.hpp - the arrays of nodes: part of describe_state.hpp.
#pragma once

#include "core/model/row_kinds.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Motion of the nodes: part of `describe_state`.
template <class Stored>
void describe_motion(NodeState& n, Stored&& stored) {
  stored({.name = "node.motion",
          .unit = "m, -, m/s, -",
          .meaning = "position x y z, pad, velocity x y z, pad",
          .rows = "nodes",
          .numbers = 8,
          .parts = {{"position", 3}, "", {"velocity", 3}, ""}},
         n.motion);
  stored({.name = "node.work_external",
          .unit = "J",
          .meaning = "work of loads and supports",
          .rows = "nodes"},
         n.work_external);
  stored({.name = "node.work_damping",
          .unit = "J",
          .meaning = "work taken out by damping",
          .rows = "nodes"},
         n.work_damping);
  stored({.name = "node.step_change",
          .unit = "J",
          .meaning = "energy that changes of the step hide",
          .rows = "nodes"},
         n.step_change);
  stored({.name = "node.peak",
          .unit = "m2/s2",
          .meaning = "largest squared speed since the last dynamic stage began",
          .rows = "nodes",
          .optional = true},
         n.peak);
  stored({.name = "node.reaction",
          .unit = "N, -",
          .meaning = "force of its support, and a pad",
          .rows = "nodes",
          .numbers = 4,
          .parts = {{"force", 3}, ""}},
         n.reaction);
  stored({.name = "node.bonded_node",
          .meaning = "label shared by nodes that intact bonds hold together",
          .rows = "nodes",
          .refers_to = {"nodes"}},
         n.bonded_node);
  stored({.name = "node.body",
          .meaning = "label shared by nodes of all blocks that bonds join",
          .rows = "nodes",
          .refers_to = {"nodes"}},
         n.body);
}

/// Adaptive relaxation of the nodes: part of `describe_state`.
template <class Stored>
void describe_relaxation(NodeState& n, Stored&& stored) {
  stored({.name = "node.relax",
          .unit = "N, 1, m/s, -",
          .meaning = "force, slowing down and velocity of the last step, of adaptive relaxation",
          .rows = "nodes",
          .numbers = 8,
          .parts = {{"force", 3}, "left", {"velocity", 3}, ""},
          .optional = true},
         n.relax);
  stored({.name = "node.relax_mass",
          .unit = "kg",
          .meaning = "scaled mass of adaptive relaxation",
          .rows = "nodes",
          .optional = true},
         n.relax_mass);
}

/// Removed blocks, and the forces that they left: part of `describe_state`.
template <class Stored>
void describe_taken_out(NodeState& n, Stored&& stored) {
  stored({.name = "node.out",
          .meaning = "1: of a block that was taken out",
          .rows = "nodes",
          .optional = true},
         n.out);
  stored({.name = "node.relief",
          .unit = "N, -",
          .meaning = "force of removed blocks, x y z; a part may not be released yet",
          .rows = "nodes",
          .numbers = 4,
          .parts = {{"force", 3}, ""},
          .optional = true},
         n.relief);
}

/// Data of the last sampled step for the energy ledger: part of `describe_state`.
template <class Stored>
void describe_samples(NodeState& n, Stored&& stored) {
  stored({.name = "node.sample",
          .unit = "J, J, J, -",
          .meaning = "kinetic energy; external and damping work of the half step to come; pad",
          .rows = "nodes",
          .numbers = 4,
          .parts = {"kinetic", "external", "damping", ""}},
         n.sample);
  stored({.name = "node.unbalance",
          .unit = "N",
          .meaning = "|x| + |y| + |z| of the unbalanced force on free components",
          .rows = "nodes"},
         n.unbalance);
}

/// Forces of the nodes: part of `describe_state`.
template <class Stored>
void describe_node_forces(State& s, Stored&& stored) {
  NodeState& n = s.nodes;
  stored({.name = "node.force",
          .unit = "N, N/m",
          .meaning = "force x y z, stiffness of its contacts",
          .rows = "nodes",
          .numbers = 4,
          .parts = {{"force", 3}, "contact_stiffness"}},
         n.force);
  stored({.name = "node.contact_stiffness",
          .unit = "N/m",
          .meaning = "stiffness that contacts may put on it before the next rebuild",
          .rows = "nodes"},
         s.node_potential);
  stored({.name = "node.bond_stiffness",
          .unit = "N/m",
          .meaning = "stiffness of its live bonds",
          .rows = "nodes"},
         s.node_bonds);
  stored({.name = "node.damping_force",
          .unit = "N, -",
          .meaning = "damping force x y z, and a pad",
          .rows = "nodes",
          .numbers = 4,
          .parts = {{"force", 3}, ""},
          .optional = true},
         n.damping_force);
}

/// Lists of nodes: part of `describe_state`.
template <class Rebuilt>
void describe_node_lists(State& s, Rebuilt&& rebuilt) {
  NodeState& n = s.nodes;
  rebuilt("find_awake",
          {.name = "node.sleeps", .meaning = "1: held, and nothing awake pulls", .rows = "nodes"},
          n.sleeps);
  rebuilt("list_awake_nodes",
          {.name = "node.listed", .meaning = "1: of a face on a pair list", .rows = "nodes"},
          n.listed);
  rebuilt("list_awake_nodes",
          {.name = "node.awake",
           .meaning = "blocks of nodes that are computed",
           .refers_to = {blocks_of("nodes")}},
          n.awake);
  rebuilt("find_fused_blocks",
          {.name = "node.fused",
           .meaning = "1: moved by the fused kernel",
           .rows = "nodes",
           .optional = true},
          n.fused);
  rebuilt("find_fused_blocks",
          {.name = "node.general",
           .meaning = "awake blocks of nodes, without completely fused ones",
           .refers_to = {blocks_of("nodes")}},
          n.general);
}

/// Forces on nodes that follow from other arrays: part of `describe_state`.
template <class Rebuilt>
void describe_node_sums(State& s, Rebuilt&& rebuilt) {
  NodeState& n = s.nodes;
  rebuilt("list_tiles",
          {.name = "node.tile_first",
           .meaning = "rows of tiles at a node",
           .rows = "nodes",
           .layout = Layout::starts,
           .refers_to = {"tile_rows"}},
          n.tile_first);
  rebuilt("list_element_corners",
          {.name = "node.element_first",
           .meaning = "corners of elements at a node",
           .rows = "nodes",
           .layout = Layout::starts,
           .refers_to = {"node_elements"}},
          n.element_first);
  rebuilt("list_element_corners",
          {.name = "node.element_corner",
           .meaning = "such a corner",
           .rows = "node_elements",
           .refers_to = {"element_corners"}},
          n.element_corner);
  rebuilt("list_corners",
          {.name = "node.corner_first",
           .meaning = "corner rows of live pairs and bolts at a node",
           .rows = "nodes",
           .layout = Layout::starts,
           .refers_to = {"live_corners"}},
          n.corner_first);
  rebuilt("list_corners",
          {.name = "node.corner",
           .meaning = "corner row that the node adds",
           .rows = "live_corners",
           .refers_to = {"corner_rows"},
           .opposite = true},
          n.corner);
  rebuilt("list_lumped",
          {.name = "node.lumped",
           .meaning = "1: its block has bonds and moves lumped masses",
           .rows = "nodes",
           .optional = true},
          n.lumped);
  rebuilt("find_loads_and_supports",
          {.name = "curve.load_factor", .meaning = "factor in this step", .rows = "curves"},
          s.load_factor);
  rebuilt("find_loads_and_supports",
          {.name = "curve.velocity_factor",
           .meaning = "factor in the middle of the coming step",
           .rows = "curves"},
          s.velocity_factor);
}

}  // namespace cdem
