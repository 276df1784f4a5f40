// describe_search.hpp - the arrays of exposed faces and pair lists.
#pragma once

#include "core/model/column_info.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Exposed faces and the surface that they make: part of `describe_search`.
template <class Stored, class Rebuilt>
void describe_exposed(SearchState& search, Stored&& stored, Rebuilt&& rebuilt) {
  stored({.name = "search.exposed_face",
          .meaning = "face that can be touched",
          .rows = "exposed",
          .refers_to = {"faces"}},
         search.exposed_face);
  stored({.name = "search.face_exposed",
          .meaning = "place of a face among the exposed ones, or -1",
          .rows = "faces",
          .refers_to = {"exposed"}},
         search.face_exposed);
  stored({.name = "search.across",
          .meaning = "face beyond a side, or -1",
          .rows = "slots",
          .refers_to = {"faces"}},
         search.across);
  stored({.name = "search.edge_star_first",
          .meaning = "edges that leave the nodes of a label, see node.bonded_node",
          .rows = "nodes",
          .layout = Layout::starts,
          .refers_to = {"star_ends"}},
         search.edge_star_first);
  stored({.name = "search.edge_star",
          .meaning = "other end of the edge",
          .rows = "star_ends",
          .refers_to = {"nodes"}},
         search.edge_star);
  stored({.name = "search.contact_first",
          .meaning = "slots of a node's exposed faces that are listed",
          .rows = "nodes",
          .layout = Layout::starts,
          .refers_to = {"contact_corners"}},
         search.contact_first);
  stored({.name = "search.contact_corner",
          .meaning = "slot that the node adds",
          .rows = "contact_corners",
          .refers_to = {"slots"}},
         search.contact_corner);
  rebuilt("list_exposed",
          {.name = "search.exposed",
           .unit = "-",
           .meaning = "bytes of the row of an exposed face, see ExposedRow",
           .rows = "exposed",
           .numbers = sizeof(ExposedRow)},
          search.exposed);
}

/// Outer list of vertices and faces: part of `describe_search`.
template <class Stored>
void describe_outer_faces(OuterList& outer, Stored&& stored) {
  stored({.name = "outer.slot_first",
          .meaning = "faces that a vertex may touch",
          .rows = "slots",
          .layout = Layout::starts,
          .refers_to = {"outer_faces"}},
         outer.slot_first);
  stored({.name = "outer.slot_pairs",
          .meaning = "pair of the vertex and a face that it may touch",
          .rows = "outer_faces",
          .refers_to = {"outer_vertex_faces"}},
         outer.slot_pairs);
  stored({.name = "outer.vf_pairs",
          .meaning = "node of the vertex, and exposed face",
          .rows = "outer_vertex_faces",
          .numbers = 2,
          .parts = {"node", "face"},
          .layout = Layout::columns,
          .refers_to = {"nodes", "exposed"}},
         outer.vf_pairs);
  stored({.name = "outer.vf_bounds",
          .unit = "m",
          .meaning = "how far apart they may be in contact, see MarkNearFaces and Short",
          .rows = "outer_vertex_faces",
          .numbers = 6,
          .layout = Layout::columns},
         outer.vf_bounds);
  stored({.name = "outer.acting_first",
          .meaning = "faces whose contacts may act on a face, where a law asks for areas",
          .rows = "exposed",
          .layout = Layout::starts,
          .refers_to = {"acting_faces"},
          .optional = true},
         outer.acting_first);
  stored({.name = "outer.faces_acting_on",
          .meaning = "exposed face whose contacts may act on it",
          .rows = "acting_faces",
          .refers_to = {"exposed"}},
         outer.faces_acting_on);
  stored({.name = "outer.face_listed",
          .meaning = "1: it may act on a face, or one on it",
          .rows = "exposed"},
         outer.face_listed);
  stored({.name = "outer.rotation_soon",
          .unit = "rad",
          .meaning = "how far a face may rotate as long as an inner list holds",
          .rows = "exposed"},
         outer.rotation_soon);
}

/// Predicted motion of the nodes of exposed faces: part of `describe_search`.
template <class Stored, class Rebuilt>
void describe_predicted(OuterList& outer, Stored&& stored, Rebuilt&& rebuilt) {
  stored({.name = "outer.predicted_nodes",
          .meaning = "node whose displacement calls for a rebuild",
          .rows = "predicted",
          .refers_to = {"nodes"}},
         outer.predicted_nodes);
  stored({.name = "outer.predicted",
          .unit = "m, m2, m/s, m",
          .meaning = "position at the rebuild, skin squared, predicted velocity, skin",
          .rows = "predicted",
          .numbers = 8,
          .parts = {{"position", 3}, "skin_squared", {"velocity", 3}, "skin"}},
         outer.predicted);
  rebuilt("place_predicted_nodes",
          {.name = "outer.node_predicted",
           .meaning = "place of a node among the predicted ones, or -1",
           .rows = "nodes",
           .refers_to = {"predicted"}},
          outer.node_predicted);
}

/// Outer list of pairs of edges: part of `describe_search`.
template <class Stored>
void describe_outer_edges(OuterList& outer, Stored&& stored) {
  stored({.name = "outer.ee_pairs",
          .meaning = "the two edges of a pair",
          .rows = "outer_edge_pairs",
          .numbers = 2,
          .layout = Layout::columns,
          .refers_to = {"outer_edges"}},
         outer.ee_pairs);
  stored({.name = "outer.ee_codes",
          .meaning = "sides that may touch and ends that are shared, as bits, see EdgeWays",
          .rows = "outer_edge_pairs"},
         outer.ee_codes);
  stored({.name = "outer.ee_bounds",
          .unit = "m",
          .meaning = "how far apart a contact may begin, see MarkNearEdges and Short",
          .rows = "outer_edge_pairs",
          .numbers = 6,
          .layout = Layout::columns},
         outer.ee_bounds);
  stored({.name = "outer.ee_sides",
          .meaning = "sides of the faces at an edge; -1: one only",
          .rows = "outer_edges",
          .numbers = 2,
          .refers_to = {"slots"}},
         outer.ee_sides);
  stored({.name = "outer.ee_edges",
          .meaning = "the edge of the mesh that it is",
          .rows = "outer_edges",
          .refers_to = {"edges"}},
         outer.ee_edges);
  stored({.name = "outer.edge_first",
          .meaning = "pairs of an edge with edges of higher numbers",
          .rows = "edges",
          .layout = Layout::starts,
          .refers_to = {"pairs_of_edges"},
          .optional = true},
         outer.edge_first);
  stored({.name = "outer.edge_pairs",
          .meaning = "pair that an edge is of",
          .rows = "pairs_of_edges",
          .refers_to = {"outer_edge_pairs"}},
         outer.edge_pairs);
}

/// Inner list of vertices and faces: part of `describe_search`.
template <class Rebuilt>
void describe_inner_faces(InnerList& inner, Rebuilt&& rebuilt) {
  rebuilt("prune_pair_list",
          {.name = "inner.predicted",
           .unit = "m, m2, m/s, m",
           .meaning = "position when it was made, skin squared, predicted velocity, skin",
           .rows = "predicted",
           .numbers = 8,
           .parts = {{"position", 3}, "skin_squared", {"velocity", 3}, "skin"}},
          inner.predicted);
  rebuilt("prune_pair_list",
          {.name = "inner.skin", .unit = "m", .meaning = "skin of a node", .rows = "nodes"},
          inner.skin);
  rebuilt("prune_pair_list",
          {.name = "inner.motion",
           .unit = "m",
           .meaning = "how far the vertex may soon move as seen from the face, see Short",
           .rows = "outer_vertex_faces"},
          inner.motion);
  rebuilt("prune_pair_list",
          {.name = "inner.faces",
           .meaning = "1: vertex and face are near",
           .rows = "outer_vertex_faces"},
          inner.faces);
  rebuilt("prune_pair_list",
          {.name = "inner.candidates",
           .meaning = "1: the vertex may soon touch the face",
           .rows = "outer_faces"},
          inner.candidates);
  rebuilt("prune_pair_list",
          {.name = "inner.count", .meaning = "faces that a vertex may soon touch", .rows = "slots"},
          inner.count);
  rebuilt("prune_pair_list",
          {.name = "inner.first",
           .meaning = "faces that a vertex may soon touch",
           .rows = "slots",
           .layout = Layout::starts,
           .refers_to = {"inner_faces"}},
          inner.first);
  rebuilt("prune_pair_list",
          {.name = "inner.candidate",
           .meaning = "exposed face that the vertex may soon touch",
           .rows = "inner_faces",
           .refers_to = {"exposed"}},
          inner.candidate);
  rebuilt("prune_pair_list",
          {.name = "inner.rises",
           .meaning = "1: the surface may rise at a side of the face",
           .rows = "inner_faces"},
          inner.rises);
  rebuilt("find_target_faces",
          {.name = "inner.may_begin",
           .meaning = "1: a contact may begin in this step",
           .rows = "inner_faces"},
          inner.may_begin);
}

/// Inner list of pairs of edges: part of `describe_search`.
template <class Rebuilt>
void describe_inner_edges(InnerList& inner, Rebuilt&& rebuilt) {
  rebuilt("prune_pair_list",
          {.name = "inner.edges", .meaning = "1: the edges are near", .rows = "outer_edge_pairs"},
          inner.edges);
  rebuilt("prune_pair_list",
          {.name = "inner.near_edges",
           .meaning = "pair of the outer list",
           .rows = "inner_edge_pairs",
           .refers_to = {"outer_edge_pairs"}},
          inner.near_edges);
  rebuilt("prune_pair_list",
          {.name = "inner.edge_ends",
           .meaning = "ends of the first edge, and of the second",
           .rows = "inner_edge_pairs",
           .numbers = 4,
           .layout = Layout::columns,
           .refers_to = {"nodes"}},
          inner.edge_ends);
  rebuilt("prune_pair_list",
          {.name = "inner.edge_sides",
           .meaning = "sides of the faces at the first edge, and at the second",
           .rows = "inner_edge_pairs",
           .numbers = 4,
           .layout = Layout::columns,
           .refers_to = {"slots"}},
          inner.edge_sides);
  rebuilt("prune_pair_list",
          {.name = "inner.edge_codes",
           .meaning = "outer.ee_codes of the pair, and at which edges its faces are neighbours",
           .rows = "inner_edge_pairs",
           .layout = Layout::columns},
          inner.edge_codes);
  rebuilt("prune_pair_list",
          {.name = "inner.edge_of",
           .meaning = "the first edge, and the second",
           .rows = "inner_edge_pairs",
           .numbers = 2,
           .layout = Layout::columns,
           .refers_to = {"edges"}},
          inner.edge_of);
  rebuilt("find_target_edges",
          {.name = "inner.open",
           .meaning = "ways in which the edges may touch in this step, as bits",
           .rows = "inner_edge_pairs"},
          inner.open);
  rebuilt("find_target_edges",
          {.name = "inner.held",
           .meaning = "place one step ago of the contact of a side as the mother, or -1",
           .rows = "inner_edge_pairs",
           .numbers = 4,
           .layout = Layout::columns,
           .refers_to = {"old_edge_contacts"}},
          inner.held);
}

/// Call stored(info, column) or rebuilt(by, info, column) for every array of exposed faces and pair
/// lists.
template <class Stored, class Rebuilt>
void describe_search(SearchState& search, Stored&& stored, Rebuilt&& rebuilt) {
  describe_exposed(search, stored, rebuilt);
  describe_outer_faces(search.outer, stored);
  describe_predicted(search.outer, stored, rebuilt);
  describe_outer_edges(search.outer, stored);
  describe_inner_faces(search.inner, rebuilt);
  describe_inner_edges(search.inner, rebuilt);
}

}  // namespace cdem
