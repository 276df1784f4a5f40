// describe_model.hpp - the arrays of the model, which Python hands over.
#pragma once

#include "core/materials/laws.hpp"
#include "core/model/column_info.hpp"
#include "core/model/describe_modules.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

/// Nodes and their masses: part of `describe_model`.
template <class Visit>
void describe_nodes(Model& m, Visit&& given) {
  given({.name = "node.block",
         .meaning = "number of its block",
         .rows = "nodes",
         .refers_to = {"blocks"},
         .changes = Changes::with_stage},
        m.node_block);
  given({.name = "node.place",
         .meaning = "label shared by nodes that began at the same place",
         .rows = "nodes",
         .refers_to = {"nodes"},
         .changes = Changes::with_stage},
        m.node_place);
  given({.name = "node.mass",
         .unit = "kg",
         .meaning = "row sum of the mass matrix",
         .rows = "nodes",
         .changes = Changes::with_stage},
        m.mass);
  given({.name = "node.gravity_mass",
         .unit = "kg",
         .meaning = "mass that gravity acts on",
         .rows = "nodes",
         .changes = Changes::with_stage},
        m.gravity_mass);
}

/// Bounds of the frequencies of nodes, and rows of their mass matrices: part of `describe_model`.
template <class Visit>
void describe_inertia(Model& m, Visit&& given) {
  given({.name = "node.lumped_frequency_squared",
         .unit = "1/s2",
         .meaning = "bound from its elements with lumped masses",
         .rows = "nodes",
         .changes = Changes::with_stage},
        m.lumped_frequency_squared);
  given({.name = "node.frequency_squared",
         .unit = "1/s2",
         .meaning = "bound from its elements with the masses that move",
         .rows = "nodes",
         .changes = Changes::with_stage},
        m.frequency_squared);
  given({.name = "node.mass_row_first",
         .meaning = "start of its row of the mass matrix, or -1: lumped",
         .rows = "nodes",
         .refers_to = {"mass_entries"},
         .changes = Changes::with_stage},
        m.mass_row_first);
  given({.name = "node.mass_axis_stride",
         .meaning = "entries between the inverses of two axes; 0: one for all",
         .rows = "nodes",
         .changes = Changes::with_stage},
        m.mass_axis_stride);
  given({.name = "node.block_first",
         .meaning = "first node of its block",
         .rows = "nodes",
         .refers_to = {"nodes"},
         .changes = Changes::with_stage},
        m.block_first);
  given({.name = "node.block_count",
         .meaning = "nodes of its block",
         .rows = "nodes",
         .changes = Changes::with_stage},
        m.block_count);
  given({.name = "node.inverse_mass_bound",
         .unit = "1/kg",
         .meaning = "largest eigenvalue of the inverse mass matrix",
         .rows = "nodes",
         .changes = Changes::with_stage},
        m.inverse_mass_bound);
  given({.name = "node.least_mass",
         .unit = "kg",
         .meaning = "diagonal below the mass matrix, of models with added mass",
         .rows = "nodes",
         .optional = true,
         .changes = Changes::with_stage},
        m.least_mass);
}

/// Mass matrices of small blocks, and corner rows: part of `describe_model`.
template <class Visit>
void describe_node_rows(Model& m, Visit&& given) {
  given({.name = "mass.inverse",
         .meaning = "inverse mass matrices times the mass of each row's node",
         .rows = "mass_entries",
         .changes = Changes::with_stage},
        m.mass_inverse);
  given({.name = "mass.matrix",
         .meaning = "mass matrices over the mass of each row's node",
         .rows = "mass_entries",
         .changes = Changes::with_stage},
        m.mass_matrix);
  given({.name = "corner.first",
         .meaning = "corner rows of all pairs and bolts at a node",
         .rows = "nodes",
         .layout = Layout::starts,
         .refers_to = {"node_corners"}},
        m.corner_first);
  given({.name = "corner.row",
         .meaning = "corner row that the node adds",
         .rows = "node_corners",
         .refers_to = {"corner_rows"},
         .opposite = true},
        m.corner);
}

/// One set of elements: part of `describe_model`.
template <class Visit>
void describe_set(const char* rows, ElementSet& e, Visit&& given) {
  const std::string set = std::string(rows) + ".";
  given({.name = set + "nodes",
         .meaning = "nodes of an element",
         .rows = rows,
         .numbers = e.corners,
         .layout = Layout::columns,
         .refers_to = {"nodes"}},
        e.nodes);
  given({.name = set + "material",
         .meaning = "material of an element",
         .rows = rows,
         .layout = Layout::columns,
         .refers_to = {"materials"},
         .changes = Changes::with_places},
        e.material);
  given({.name = set + "gradient",
         .unit = "1/m",
         .meaning = "dN/dX of nodes 1.. at the Gauss points of the stress-free mesh",
         .rows = rows,
         .numbers = e.points * (e.corners - 1) * 3,
         .layout = Layout::columns,
         .changes = Changes::with_places},
        e.gradient);
  given({.name = set + "volume",
         .unit = "m3",
         .meaning = "weight times Jacobian of the Gauss points",
         .rows = rows,
         .numbers = e.points,
         .layout = Layout::columns,
         .changes = Changes::with_places},
        e.volume);
  given({.name = set + "hourglass",
         .unit = "m, N/m",
         .meaning = "moments of the four modes, and their stiffness",
         .rows = rows,
         .numbers = 13,
         .parts = {{"moments", 12}, "stiffness"},
         .layout = Layout::columns,
         .optional = true,
         .changes = Changes::with_places},
        e.hourglass);
  given({.name = set + "nodal_mean",
         .meaning = "1: its dilatation is averaged at its nodes",
         .rows = rows,
         .layout = Layout::columns,
         .optional = true},
        e.nodal_mean);
  given({.name = set + "values",
         .meaning = "shape functions of the nodes at the Gauss points, where rock has pores"},
        e.values);
}

/// Bond points of overlapping faces: part of `describe_model`.
template <class Visit>
void describe_points(const std::string& set, const char* rows, PairSet& p, Visit&& given) {
  given({.name = set + "point_first",
         .meaning = "bond points of a pair of overlapping faces",
         .rows = rows,
         .layout = Layout::starts,
         .refers_to = {"overlap_points"},
         .optional = true},
        p.point_first);
  given({.name = set + "weights_a",
         .meaning = "weights of a bond point on the vertices of the first face",
         .rows = "overlap_points",
         .numbers = 4,
         .optional = true},
        p.weights_a);
  given({.name = set + "weights_b",
         .meaning = "the same on the second face",
         .rows = "overlap_points",
         .numbers = 4,
         .optional = true},
        p.weights_b);
  given({.name = set + "point_area",
         .unit = "m2",
         .meaning = "area of a bond point",
         .rows = "overlap_points",
         .optional = true},
        p.point_area);
}

/// One set of bonded pairs: part of `describe_model`.
template <class Visit>
void describe_set(const char* rows, PairSet& p, Visit&& given) {
  const std::string set = std::string(rows) + ".";
  given({.name = set + "faces",
         .meaning = "the two faces of a pair",
         .rows = rows,
         .numbers = 2,
         .refers_to = {"faces"}},
        p.faces);
  given({.name = set + "nodes",
         .meaning = "vertices of the first face, then their mates",
         .rows = rows,
         .numbers = 2 * p.points,
         .layout = Layout::columns,
         .refers_to = {"nodes"},
         .optional = true},
        p.nodes);
  given({.name = set + "interface",
         .meaning = "interface of a pair",
         .rows = rows,
         .layout = Layout::columns,
         .refers_to = {"interfaces"}},
        p.interface);
  given({.name = set + "area",
         .unit = "m2",
         .meaning = "area that the faces share",
         .rows = rows,
         .layout = Layout::columns,
         .changes = Changes::with_places},
        p.area);
  given({.name = set + "stiffness",
         .unit = "Pa/m, Pa/m",
         .meaning = "normal and shear stiffness",
         .rows = rows,
         .numbers = 2,
         .parts = {"normal", "shear"},
         .layout = Layout::columns,
         .changes = Changes::with_stage},
        p.stiffness);
  given({.name = set + "strength",
         .meaning = "factor on cohesion and tensile strength",
         .rows = rows,
         .layout = Layout::columns,
         .optional = true,
         .changes = Changes::with_stage},
        p.strength);
  describe_points(set, rows, p, given);
}

/// Exterior faces and edges: part of `describe_model`.
template <class Visit>
void describe_faces(Model& m, Visit&& given) {
  given({.name = "face.nodes",
         .meaning = "vertices, counter-clockwise from outside; -1: a triangle has three",
         .rows = "faces",
         .numbers = 4,
         .refers_to = {"nodes"}},
        m.face_nodes);
  given({.name = "face.edges",
         .meaning = "edge from vertex k to k + 1",
         .rows = "faces",
         .numbers = 4,
         .refers_to = {"edges"}},
        m.face_edges);
  given({.name = "face.interface_class",
         .meaning = "class of faces that have the same interfaces",
         .rows = "faces",
         .refers_to = {"interface_classes"}},
        m.face_interface_class);
  given({.name = "face.block",
         .meaning = "number of its block",
         .rows = "faces",
         .refers_to = {"blocks"}},
        m.face_block);
  given({.name = "face.element",
         .meaning = "element behind it",
         .rows = "faces",
         .refers_to = {"elements"}},
        m.face_element);
}

/// Sizes of exterior faces: part of `describe_model`.
template <class Visit>
void describe_face_sizes(Model& m, Visit&& given) {
  given({.name = "face.length",
         .unit = "m",
         .meaning = "L: mean distance from the centre to the vertices",
         .rows = "faces",
         .changes = Changes::with_places},
        m.face_length);
  given({.name = "face.reach",
         .unit = "m",
         .meaning = "a little more than the distance from the centre to the farthest vertex",
         .rows = "faces",
         .changes = Changes::with_places},
        m.face_reach);
  given({.name = "face.area",
         .unit = "m2",
         .meaning = "area",
         .rows = "faces",
         .changes = Changes::with_places},
        m.face_area);
  given({.name = "face.height",
         .unit = "m",
         .meaning = "height of the element behind it",
         .rows = "faces",
         .changes = Changes::with_places},
        m.face_height);
  given({.name = "face.stiffness",
         .unit = "Pa/m",
         .meaning = "Young's modulus of the element behind it over its height",
         .rows = "faces",
         .changes = Changes::with_places},
        m.face_stiffness);
  given({.name = "face.radius",
         .unit = "m",
         .meaning = "radius of a sphere of the volume of its block; 1e300: the block cannot move",
         .rows = "faces",
         .changes = Changes::with_places},
        m.face_radius);
  given(
      {.name = "face.initially_exposed", .meaning = "1: not bonded at the start", .rows = "faces"},
      m.face_initially_exposed);
  given({.name = "face.movable", .meaning = "1: its block can move", .rows = "faces"},
        m.face_movable);
}

/// Exterior edges, flush faces and interfaces of faces: part of `describe_model`.
template <class Visit>
void describe_exterior_edges(Model& m, Visit&& given) {
  given({.name = "edge.nodes",
         .meaning = "ends",
         .rows = "edges",
         .numbers = 2,
         .refers_to = {"nodes"}},
        m.edge_nodes);
  given({.name = "edge.faces",
         .meaning = "faces that meet there; -1: one only",
         .rows = "edges",
         .numbers = 2,
         .refers_to = {"faces"}},
        m.edge_faces);
  given({.name = "edge_star.first",
         .meaning = "edges that leave a node",
         .rows = "nodes",
         .layout = Layout::starts,
         .refers_to = {"edge_ends"}},
        m.edge_star_first);
  given({.name = "edge_star.node",
         .meaning = "other end of the edge",
         .rows = "edge_ends",
         .refers_to = {"nodes"}},
        m.edge_star);
  given({.name = "flush.first",
         .meaning = "faces of other blocks that began flush with it",
         .rows = "faces",
         .layout = Layout::starts,
         .refers_to = {"flush_faces"}},
        m.flush_first);
  given({.name = "flush.face",
         .meaning = "such a face",
         .rows = "flush_faces",
         .refers_to = {"faces"}},
        m.flush_face);
  given({.name = "node.flush",
         .meaning = "whether a face at the node has such faces",
         .rows = "nodes"},
        m.node_flush);
  given({.name = "interface.of",
         .meaning = "interface between two classes of faces",
         .rows = "class_pairs",
         .refers_to = {"interfaces"}},
        m.interface_of);
}

/// Loads and supports: part of `describe_model`.
template <class Visit>
void describe_loads(Model& m, Visit&& given) {
  given({.name = "load.first",
         .meaning = "loads of a node",
         .rows = "nodes",
         .layout = Layout::starts,
         .refers_to = {"loads"},
         .changes = Changes::with_stage},
        m.load_first);
  given({.name = "load.curve",
         .meaning = "curve that scales the load",
         .rows = "loads",
         .refers_to = {"curves"},
         .changes = Changes::with_stage},
        m.load_curve);
  given({.name = "load.force",
         .unit = "N, -",
         .meaning = "force x y z, and a pad",
         .rows = "loads",
         .numbers = 4,
         .parts = {{"force", 3}, ""},
         .changes = Changes::with_stage},
        m.load_force);
  given({.name = "support.row",
         .meaning = "support of a node, or -1",
         .rows = "nodes",
         .refers_to = {"supports"},
         .changes = Changes::with_stage},
        m.support);
  given({.name = "support.component",
         .meaning = "1: the velocity is given along this axis",
         .rows = "supports",
         .numbers = 3,
         .changes = Changes::with_stage},
        m.support_component);
  given({.name = "support.curve",
         .meaning = "curve that scales the velocity",
         .rows = "supports",
         .numbers = 3,
         .refers_to = {"curves"},
         .changes = Changes::with_stage},
        m.support_curve);
  given({.name = "support.velocity",
         .unit = "m/s",
         .meaning = "given velocity",
         .rows = "supports",
         .numbers = 3,
         .changes = Changes::with_stage},
        m.support_velocity);
}

/// Call visit(info, column) for every array of the model that Python hands over.
template <class Visit>
void describe_model(Model& m, State& s, Visit&& visit) {
  const auto given = [&](const ColumnInfo& info, auto& column) { visit(info, column); };
  describe_nodes(m, given);
  describe_inertia(m, given);
  describe_node_rows(m, given);
  given({.name = "material.lambda",
         .unit = "Pa",
         .meaning = "first Lame constant",
         .rows = "materials",
         .changes = Changes::with_stage},
        m.material_lambda);
  given({.name = "material.mu",
         .unit = "Pa",
         .meaning = "shear modulus",
         .rows = "materials",
         .changes = Changes::with_stage},
        m.material_mu);
  given({.name = "material.law",
         .meaning = "number of the block law",
         .rows = "materials",
         .changes = Changes::with_places},
        m.material_law);
  given({.name = "material.parameters",
         .unit = "see the law",
         .meaning = "parameters of the block law",
         .rows = "materials",
         .numbers = material_row,
         .changes = Changes::with_stage},
        m.material_parameters);
  const auto describe = [&](const auto& kind, auto& set, auto&) {
    describe_set(kind.name, set, given);
  };
  for_each_element_set(m, s, describe);
  for_each_pair_set(m, s, describe);
  describe_modules(m, s, given);
  describe_faces(m, given);
  describe_face_sizes(m, given);
  describe_exterior_edges(m, given);
  describe_loads(m, given);
}

}  // namespace cdem
