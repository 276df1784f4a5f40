// describe_state.hpp - the arrays of nodes, elements and bonded pairs.
#pragma once

#include "core/interfaces/laws.hpp"
#include "core/materials/laws.hpp"
#include "core/model/column_info.hpp"
#include "core/model/describe_rows.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

/// Motion of the nodes: part of `describe_state`.
template <class Stored>
void describe_motion(NodeState& n, Stored&& stored) {
  stored({.name = "node.motion",
          .unit = "m, m/s",
          .meaning = "position x y z, pad, velocity x y z, pad",
          .rows = "nodes",
          .numbers = 8},
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
  stored({.name = "node.reaction",
          .unit = "N",
          .meaning = "force of its support, and a pad",
          .rows = "nodes",
          .numbers = 4},
         n.reaction);
  stored({.name = "node.relax",
          .unit = "N, m/s",
          .meaning = "force, slowing down and velocity of the last step, of adaptive relaxation",
          .rows = "nodes",
          .numbers = 8,
          .optional = true},
         n.relax);
  stored({.name = "node.relax_mass",
          .unit = "kg",
          .meaning = "scaled mass of adaptive relaxation",
          .rows = "nodes",
          .optional = true},
         n.relax_mass);
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

/// What was taken out, and the forces that it left: part of `describe_state`.
template <class Stored>
void describe_taken_out(NodeState& n, Stored&& stored) {
  stored({.name = "node.out",
          .meaning = "1: of a block that was taken out",
          .rows = "nodes",
          .optional = true},
         n.out);
  stored({.name = "node.relief",
          .unit = "N",
          .meaning = "force of what was dug out, x y z, of which a part may be left",
          .rows = "nodes",
          .numbers = 4,
          .optional = true},
         n.relief);
}

/// Water: part of `describe_state`.
template <class Stored, class Rebuilt>
void describe_water(const Model& m, State& s, Stored&& stored, Rebuilt&& rebuilt) {
  stored({.name = "node.water",
          .unit = "N",
          .meaning = "force of water, x y z, and a pad",
          .rows = "nodes",
          .numbers = 4,
          .optional = true},
         s.nodes.water);
  stored({.name = "node.work_water",
          .unit = "J",
          .meaning = "work of water",
          .rows = "nodes",
          .optional = true},
         s.nodes.work_water);
  rebuilt("update_water",
          {.name = "water.fields_now",
           .unit = "Pa, Pa/m",
           .meaning = "pressure fields in this step, see WaterFields",
           .rows = "water_fields",
           .numbers = 8},
          s.water.fields);
  rebuilt("update_water",
          {.name = "wet_triangles.field",
           .meaning = "field that presses on a vertex",
           .rows = "wet_triangles",
           .numbers = m.water.triangles.vertices,
           .layout = Layout::columns,
           .refers_to = {"water_fields"},
           .optional = true},
          s.water.triangle_field);
  rebuilt("update_water",
          {.name = "wet_quads.field",
           .meaning = "field that presses on a vertex",
           .rows = "wet_quads",
           .numbers = m.water.quads.vertices,
           .layout = Layout::columns,
           .refers_to = {"water_fields"},
           .optional = true},
          s.water.quad_field);
  rebuilt("update_water",
          {.name = "water.force",
           .unit = "N",
           .meaning = "force of water on a vertex of a face or a node of an element, and a pad",
           .rows = "water_rows",
           .numbers = 4},
          s.water.force);
  rebuilt("update_water",
          {.name = "water.node_pressure",
           .unit = "Pa",
           .meaning = "pressure in the pores",
           .rows = "nodes",
           .optional = true},
          s.water.node_pressure);
}

/// What the last sampled step left for the energy ledger: part of `describe_state`.
template <class Stored>
void describe_samples(NodeState& n, Stored&& stored) {
  stored({.name = "node.sample",
          .unit = "J",
          .meaning = "kinetic energy; external and damping work of the half step to come; pad",
          .rows = "nodes",
          .numbers = 4},
         n.sample);
  stored({.name = "node.unbalance",
          .unit = "N",
          .meaning = "|x| + |y| + |z| of the unbalanced force on free components",
          .rows = "nodes"},
         n.unbalance);
}

/// Forces of the nodes: part of `describe_state`.
template <class Rebuilt>
void describe_node_forces(NodeState& n, Rebuilt&& rebuilt) {
  rebuilt("advance_nodes",
          {.name = "node.force",
           .unit = "N, N/m",
           .meaning = "force x y z, stiffness of its contacts",
           .rows = "nodes",
           .numbers = 4},
          n.force);
  rebuilt("advance_nodes",
          {.name = "node.damping_force",
           .unit = "N",
           .meaning = "damping force x y z, and a pad",
           .rows = "nodes",
           .numbers = 4,
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
           .meaning = "awake blocks of nodes but those that are fused as a whole",
           .refers_to = {blocks_of("nodes")}},
          n.general);
}

/// What acts on nodes as far as it follows from the rest: part of `describe_state`.
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
  rebuilt("sum_stiffness",
          {.name = "node.contact_stiffness",
           .unit = "N/m",
           .meaning = "stiffness that contacts may put on it before the next rebuild",
           .rows = "nodes"},
          s.node_potential);
  rebuilt("sum_stiffness",
          {.name = "node.bond_stiffness",
           .unit = "N/m",
           .meaning = "stiffness of its live bonds",
           .rows = "nodes"},
          s.node_bonds);
  rebuilt("set_loads_and_supports",
          {.name = "curve.load_factor", .meaning = "factor in this step", .rows = "curves"},
          s.load_factor);
  rebuilt("set_loads_and_supports",
          {.name = "curve.velocity_factor",
           .meaning = "factor in the middle of the coming step",
           .rows = "curves"},
          s.velocity_factor);
}

/// Tiles of elements: part of `describe_state`.
template <class Rebuilt>
void describe_tiles(const char* rows, const ElementSet& set, ElementTiles& tiles,
                    Rebuilt&& rebuilt) {
  const std::string name = std::string(rows) + ".";
  rebuilt("list_tiles",
          {.name = name + "tile.blocks",
           .meaning = "blocks of elements of a tile",
           .rows = tiles_of(rows),
           .layout = Layout::starts,
           .refers_to = {blocks_of(rows)}},
          tiles.block_first);
  rebuilt("list_tiles",
          {.name = name + "tile.nodes",
           .meaning = "nodes that come to the tile with a block",
           .rows = blocks_of(rows),
           .layout = Layout::starts,
           .refers_to = {tile_nodes_of(rows)}},
          tiles.node_first);
  rebuilt("list_tiles",
          {.name = name + "tile.node",
           .meaning = "node of a tile",
           .rows = tile_nodes_of(rows),
           .refers_to = {"nodes"}},
          tiles.node);
  rebuilt("list_tiles",
          {.name = name + "tile.row",
           .meaning = "row of the tile's force on the node",
           .rows = tile_nodes_of(rows),
           .refers_to = {"tile_rows"}},
          tiles.row);
  rebuilt("list_tiles",
          {.name = name + "tile.place",
           .meaning = "place of a node of an element among those of its tile",
           .rows = rows,
           .numbers = set.corners,
           .layout = Layout::columns},
          tiles.place);
}

/// Blocks of elements that the fused kernel moves: part of `describe_state`.
template <class Rebuilt>
void describe_fused(const char* rows, FusedBlocks& fused, Rebuilt&& rebuilt) {
  const std::string name = std::string(rows) + ".", blocks = blocks_of(rows);
  rebuilt("find_fused_blocks",
          {.name = name + "fused.blocks",
           .meaning = "blocks of elements that the fused kernel moves, full mass matrices",
           .refers_to = {blocks}},
          fused.blocks);
  rebuilt("find_fused_blocks",
          {.name = name + "fused.lumped",
           .meaning = "the same with lumped masses",
           .refers_to = {blocks}},
          fused.lumped);
  rebuilt("find_fused_blocks",
          {.name = name + "fused.general",
           .meaning = "awake blocks of the other elements",
           .refers_to = {blocks}},
          fused.general);
  rebuilt("find_fused_blocks",
          {.name = name + "fused.row_first",
           .meaning = "corner rows of bonds at a fused block",
           .rows = blocks,
           .layout = Layout::starts,
           .refers_to = {fused_rows_of(rows)}},
          fused.row_first);
  rebuilt("find_fused_blocks",
          {.name = name + "fused.row",
           .meaning = "corner row of a bond, or the one that adds nothing",
           .rows = fused_rows_of(rows),
           .refers_to = {"corner_rows"},
           .opposite = true},
          fused.row);
}

/// One set of elements: part of `describe_state`.
template <class Stored, class Rebuilt>
void describe_set(const char* rows, const ElementSet& set, ElementState& e, Stored&& stored,
                  Rebuilt&& rebuilt) {
  const std::string name = std::string(rows) + ".";
  stored({.name = name + "point_stress",
          .unit = "Pa",
          .meaning = "stress at the Gauss points, of incremental formulations",
          .rows = rows,
          .numbers = 6 * set.points,
          .layout = Layout::columns,
          .optional = true},
         e.point_stress);
  stored({.name = name + "energy",
          .unit = "J",
          .meaning = "stored energy",
          .rows = rows,
          .layout = Layout::columns},
         e.energy);
  stored({.name = name + "damping_work",
          .unit = "J",
          .meaning = "work of the stiffness dashpot",
          .rows = rows,
          .layout = Layout::columns},
         e.damping_work);
  stored({.name = name + "history",
          .unit = "1, and of the law",
          .meaning = "inelastic strain and state of the law at the Gauss points",
          .rows = rows,
          .numbers = point_history * set.points,
          .layout = Layout::columns,
          .optional = true},
         e.history);
  stored({.name = name + "plastic_work",
          .unit = "J",
          .meaning = "work of inelastic strain",
          .rows = rows,
          .layout = Layout::columns,
          .optional = true},
         e.plastic_work);
  rebuilt("report_elements",
          {.name = name + "stress",
           .unit = "Pa",
           .meaning = "mean stress, for output",
           .rows = rows,
           .numbers = 6,
           .layout = Layout::columns},
          e.stress);
  rebuilt("report_elements",
          {.name = name + "yielded",
           .meaning = "what flows now and what ever has, for output",
           .rows = rows,
           .layout = Layout::columns,
           .optional = true},
          e.yielded);
  rebuilt("find_awake",
          {.name = name + "awake",
           .meaning = "blocks of elements that are computed",
           .refers_to = {blocks_of(rows)}},
          e.awake);
  describe_fused(rows, e.fused, rebuilt);
}

/// One set of bonded pairs: part of `describe_state`.
template <class Stored, class Rebuilt>
void describe_set(const char* rows, const PairSet& set, PairState& p, Stored&& stored,
                  Rebuilt&& rebuilt) {
  const std::string name = std::string(rows) + ".";
  const auto of_pair = [&](const char* column, const char* unit, const char* meaning,
                           Column<Real>& numbers) {
    stored({.name = name + column,
            .unit = unit,
            .meaning = meaning,
            .rows = rows,
            .layout = Layout::columns},
           numbers);
  };
  const auto of_point = [&](const char* column, const char* unit, const char* meaning,
                            Column<Real>& numbers, Index axes = 1) {
    stored({.name = name + column,
            .unit = unit,
            .meaning = meaning,
            .rows = conforms(set) ? rows : "overlap_points",
            .numbers = axes * set.points,
            .layout = Layout::columns,
            .optional = &numbers == &p.rest || &numbers == &p.rise},
           numbers);
  };
  stored({.name = name + "status",
          .meaning = "0: released to the contact search, 1: bonded, 2: open hinge",
          .rows = rows,
          .layout = Layout::columns},
         p.status);
  of_point("bond", "1", "1 while intact, 0 once broken", p.bond);
  of_point("slip1", "m", "plastic slip along the first axis of the pair", p.slip1);
  of_point("slip2", "m", "plastic slip along the second axis of the pair", p.slip2);
  of_point("rest", "m", "jump at which a spring is free, along the axes of the pair", p.rest, 3);
  of_point("rise", "m", "of that jump across the pair, by dilation", p.rise);
  stored({.name = name + "history",
          .unit = "of the law",
          .meaning = "what the law remembers at the bond points",
          .rows = conforms(set) ? rows : "overlap_points",
          .numbers = p.history.size() > 0 ? InterfaceLaws::most_state * set.points : 0,
          .layout = Layout::columns},
         p.history);
  of_pair("broken_tension", "1", "springs broken in tension", p.broken_tension);
  of_pair("broken_shear", "1", "springs broken in shear", p.broken_shear);
  of_pair("jump", "m", "change of a broken pair's largest jump since it broke", p.jump);
  of_pair("jump_at_break", "m", "that jump when it broke, or -1", p.jump_at_break);
  of_pair("stored", "J", "elastic energy", p.stored);
  of_pair("fracture", "J", "energy of fracture", p.fracture);
  of_pair("friction", "J", "frictional work", p.friction);
  rebuilt("find_awake",
          {.name = name + "awake",
           .meaning = "blocks of pairs that are computed",
           .refers_to = {blocks_of(rows)}},
          p.awake);
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

/// Dilatation that is averaged at nodes: part of `describe_state`.
template <class Stored, class Rebuilt>
void describe_nodal_means(NodalMeans& n, Stored&& stored, Rebuilt&& rebuilt) {
  stored({.name = "tet4.start_dilatation",
          .meaning = "elastic dilatation at the start, which is not averaged",
          .rows = "tet4",
          .layout = Layout::columns,
          .optional = true},
         n.start);
  stored({.name = "node.dilatation",
          .meaning = "mean elastic dilatation of its tets since the start, after the last step",
          .rows = "nodes",
          .optional = true},
         n.after);
  const auto of_tet = [&](const char* name, const char* meaning, Column<Real>& column) {
    rebuilt("update_nodal_means",
            {.name = name,
             .meaning = meaning,
             .rows = "tet4",
             .layout = Layout::columns,
             .optional = true},
            column);
  };
  of_tet("tet4.dilatation", "elastic dilatation since the start", n.own);
  of_tet("tet4.flowed_dilatation", "inelastic dilatation of the step", n.flowed);
  rebuilt("update_nodal_means",
          {.name = "node.trial_dilatation",
           .meaning = "mean elastic dilatation of its tets before the laws moved on",
           .rows = "nodes",
           .optional = true},
          n.trial);
  const auto of_blocks = [&](const char* name, const char* meaning, const char* rows,
                             Column<Index>& column) {
    rebuilt("list_nodal_means", {.name = name, .meaning = meaning, .refers_to = {blocks_of(rows)}},
            column);
  };
  of_blocks("tet4.averaged", "blocks of tiles with a tet that is averaged", "tet4", n.blocks);
  of_blocks("tet4.not_averaged", "the other ones", "tet4", n.other_blocks);
  of_blocks("node.averaging", "blocks of nodes with one of an averaged tet", "nodes",
            n.node_blocks);
  rebuilt("list_nodal_means",
          {.name = "node.tet_first",
           .meaning = "tets at a node",
           .rows = "nodes",
           .layout = Layout::starts,
           .refers_to = {"node_tets"},
           .optional = true},
          n.tet_first);
  rebuilt("list_nodal_means",
          {.name = "node.tet",
           .meaning = "tet at a node",
           .rows = "node_tets",
           .refers_to = {"tet4"},
           .optional = true},
          n.tet);
}

/// Call stored(info, column) or rebuilt(by, info, column) for every array of nodes and force sets.
template <class Stored, class Rebuilt>
void describe_state(const Model& m, State& s, Stored&& stored, Rebuilt&& rebuilt) {
  describe_motion(s.nodes, stored);
  describe_taken_out(s.nodes, stored);
  describe_water(m, s, stored, rebuilt);
  describe_samples(s.nodes, stored);
  describe_node_forces(s.nodes, rebuilt);
  describe_node_lists(s, rebuilt);
  describe_node_sums(s, rebuilt);
  for_each_set(m, s, [&](const auto& kind, const auto& set, auto& state) {
    describe_set(kind.name, set, state, stored, rebuilt);
  });
  for_each_element_set(m, s, [&](const auto& kind, const ElementSet& e, ElementState& es) {
    describe_tiles(kind.name, e, es.tiles, rebuilt);
  });
  describe_nodal_means(s.nodal, stored, rebuilt);
  rebuilt("update_element_forces",
          {.name = "tile.force",
           .unit = "N",
           .meaning = "force of the elements of a tile on a node, and a pad",
           .rows = "tile_rows",
           .numbers = 4},
          s.tile_force);
  rebuilt("update_bond_forces",
          {.name = "corner.force",
           .unit = "N",
           .meaning = "force of a pair or a bolt on a node, and a pad",
           .rows = "corner_rows",
           .numbers = 4},
          s.corner_force);
  rebuilt("release_bonds",
          {.name = "overlaps.released",
           .meaning = "overlaps whose contacts are still to be found in the step",
           .refers_to = {"overlaps"}},
          s.released_overlaps);
}

}  // namespace cdem
