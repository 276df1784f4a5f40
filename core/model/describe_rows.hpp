// describe_rows.hpp - the kinds of rows that arrays have, and how many there are of each.
#pragma once

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/row_kinds.hpp"

namespace cdem {

/// How many rows there are, by their starts.
inline Index end_of(const Column<Index>& starts) {
  const auto items = on_host(starts);
  return items.size() > 0 ? items[items.size() - 1] : 0;
}

/// How many blocks there are, by their numbers at the nodes.
inline Index block_count(const Model& m) {
  const auto blocks = on_host(m.node_block);
  return blocks.size() > 0 ? 1 + *std::max_element(blocks.begin(), blocks.end()) : 0;
}

/// Visit the rows that the model has: part of `describe_rows`.
template <class Visit>
void describe_model_rows(const Model& m, const State& s, Visit&& visit) {
  static_assert(block_size == 8);  // as blocks_of has it
  const auto blocks = [](Index count) { return (count + block_size - 1) / block_size; };
  const auto total = [](const auto& column) { return Index(column.size()); };
  visit(RowKind{"nodes", "nodes of all blocks"}, m.node_count);
  visit(RowKind{blocks_of("nodes"), "eight nodes after each other"}, blocks(m.node_count));
  visit(RowKind{"node_corners", "corner rows of all pairs and bolts that a node sums"},
        end_of(m.corner_first));
  visit(RowKind{"mass_entries", "entries of mass matrices"}, total(m.mass_inverse));
  visit(RowKind{"materials", "elastic materials"}, total(m.material_lambda));
  for_each_set(m, s, [&](const auto& kind, const auto& set, const auto&) {
    visit(RowKind{kind.name, "items of this set"}, set.count);
    visit(RowKind{blocks_of(kind.name), "eight of them after each other"}, blocks(set.count));
  });
  for_each_element_set(m, s, [&](const auto& kind, const auto&, const ElementState& e) {
    visit(RowKind{fused_rows_of(kind.name), "corner rows of bonds by fused block"},
          end_of(e.fused.row_first));
    visit(RowKind{tiles_of(kind.name), "tiles of elements"}, total(e.tiles.block_first) - 1);
    visit(RowKind{tile_nodes_of(kind.name), "nodes of tiles"}, total(e.tiles.node));
  });
  visit(RowKind{"elements", "elements of all sets, one set after the other"}, element_count(m, s));
  visit(RowKind{"blocks", "discrete bodies"}, block_count(m));
  visit(RowKind{"element_corners", "corners of the elements of all sets, one set after the other"},
        element_corner_count(m, s));
  visit(RowKind{"node_elements", "corners of elements, by node"}, end_of(s.nodes.element_first));
  visit(RowKind{"tile_rows", "forces of tiles on nodes"}, end_of(s.nodes.tile_first));
  visit(RowKind{"node_tets", "tets of a node, where their dilatation is averaged"},
        total(s.nodal.tet));
  visit(RowKind{"overlap_points", "bond points of overlaps"}, end_of(m.overlaps.point_first));
  Modules::for_each([&]<class Module>() { Module::describe_rows(given_of<Module>(m), visit); });
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    const AppliedForces& of = applied_of<Module>(s);
    visit(RowKind{applied_rows_of(Module::name), "forces of a module on nodes"},
          total(of.rows) / 4);
    visit(RowKind{applied_lists_of(Module::name), "rows of the module that a node sums"},
          end_of(of.first));
  });
  visit(RowKind{"corner_rows", "forces of a set on a node; the last one adds nothing"},
        m.corner_rows + 1);
  visit(RowKind{"faces", "exterior faces of all blocks"}, m.face_count);
  visit(RowKind{"edges", "exterior edges of all blocks"}, m.edge_count);
  visit(RowKind{"edge_ends", "other ends of the edges that leave a node"},
        end_of(m.edge_star_first));
  visit(RowKind{"flush_faces", "faces of other blocks that began flush with a face"},
        end_of(m.flush_first));
  visit(RowKind{"interface_classes", "classes of faces that have the same interfaces"},
        m.class_count);
  visit(RowKind{"class_pairs", "pairs of interface classes of faces"},
        m.class_count * m.class_count);
  visit(RowKind{"interfaces", "interfaces between groups"}, total(m.interfaces));
  visit(RowKind{"loads", "forces on nodes"}, end_of(m.load_first));
  visit(RowKind{"supports", "nodes with a prescribed component"}, total(m.support_component) / 3);
  visit(RowKind{"dashed_nodes", "nodes with dashpots to the ground"}, total(s.ground.node));
  visit(RowKind{"curves", "histories of loads and supports"}, Index(m.curve_time.size()));
}

/// Visit the rows that the search makes: part of `describe_rows`.
template <class Visit>
void describe_search_rows(const State& s, Visit&& visit) {
  const auto total = [](const auto& column) { return Index(column.size()); };
  const OuterList& outer = s.search.outer;
  const InnerList& inner = s.search.inner;
  const Index exposed = total(s.search.exposed_face);
  visit(RowKind{"live_corners", "corner rows of live pairs and bolts that a node sums"},
        end_of(s.nodes.corner_first));
  visit(RowKind{"exposed", "faces that can be touched"}, exposed);
  visit(RowKind{"slots", "vertex or side k of exposed face x: 4 x + k"}, 4 * exposed);
  visit(RowKind{"star_ends", "other ends of the edges that leave a bonded node"},
        end_of(s.search.edge_star_first));
  visit(RowKind{"contact_corners", "slots that a node sums"}, end_of(s.search.contact_first));
  visit(RowKind{"edge_contacts", "contacts of semi-edges"}, end_of(s.edges.first));
  visit(RowKind{"old_edge_contacts", "contacts of one step ago"}, end_of(s.edges.old_first));
  visit(RowKind{"old_edge_states", "their states, then states from released overlaps"},
        total(s.edges.old_state) / 8);
  visit(RowKind{"contacts", "slots, then contacts of semi-edges"},
        4 * exposed + end_of(s.edges.first));
  visit(RowKind{"acting_contacts", "contacts by the face that they act on"},
        end_of(s.contacts_by_target.first));
  visit(RowKind{"outer_faces", "faces that a vertex may touch before the next rebuild"},
        end_of(outer.slot_first));
  visit(RowKind{"outer_vertex_faces", "pairs of vertex and face of the outer list, padded"},
        total(outer.vf_pairs) / 2);
  visit(RowKind{"outer_edge_pairs", "pairs of edges of the outer list"}, total(outer.ee_codes));
  visit(RowKind{"outer_edges", "edges of the exposed faces of one element"},
        total(outer.ee_sides) / 2);
  visit(RowKind{"pairs_of_edges", "pairs of edges by the lower of the two"},
        end_of(outer.edge_first));
  visit(RowKind{"acting_faces", "exposed faces whose contacts may act on a face"},
        end_of(outer.acting_first));
  visit(RowKind{"predicted", "nodes of exposed faces"}, total(outer.predicted_nodes));
  visit(RowKind{"inner_faces", "faces that a vertex may touch in the next steps"},
        end_of(inner.first));
  visit(RowKind{"inner_edge_pairs", "pairs of edges of the inner list"}, total(inner.near_edges));
}

/// Call visit(kind, count) for every kind of rows.
template <class Visit>
void describe_rows(const Model& m, const State& s, Visit&& visit) {
  describe_model_rows(m, s, visit);
  describe_search_rows(s, visit);
}

}  // namespace cdem
