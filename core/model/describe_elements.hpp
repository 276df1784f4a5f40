// describe_elements.hpp - the arrays of elements: part of describe_state.hpp.
#pragma once

#include "core/materials/laws.hpp"
#include "core/model/model.hpp"
#include "core/model/rebuilds.hpp"
#include "core/model/row_kinds.hpp"
#include "core/model/state.hpp"

namespace cdem {

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
           .meaning = "place of a node of an element among the nodes of its tile",
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

/// Damping of the rock of a set: part of `describe_state`.
template <class Stored>
void describe_damping(const char* rows, const ElementSet& set, ElementState& e, Stored&& stored) {
  const std::string name = std::string(rows) + ".";
  stored({.name = name + "damping_work",
          .unit = "J",
          .meaning = "work of dashpots and Maxwell branches",
          .rows = rows,
          .layout = Layout::columns},
         e.damping_work);
  stored({.name = name + "branch",
          .meaning = "strains of the springs of Maxwell branches at the Gauss points",
          .rows = rows,
          .numbers = 6 * MaxwellBranches::count * set.points,
          .layout = Layout::columns,
          .optional = true},
         e.branch);
  const Index modes = set.hourglass.size() > 0 ? 12 : 0;
  stored(
      {.name = name + "dashpot",
       .unit = "Pa, m/s",
       .meaning = "stress of Rayleigh dashpots at the Gauss points in the last step, then rates of "
                  "hourglass modes",
       .rows = rows,
       .numbers = 6 * set.points + modes,
       .parts = {{"stress", 6 * set.points}, {"modes", modes}},
       .layout = Layout::columns,
       .optional = true},
      e.dashpot);
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
  describe_damping(rows, set, e, stored);
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
           .meaning = "present and past plastic flow, for output",
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
  rebuilt("list_nodal_means",
          {.name = "node.averaging", .meaning = "nodes of averaged tets", .refers_to = {"nodes"}},
          n.nodes);
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

}  // namespace cdem
