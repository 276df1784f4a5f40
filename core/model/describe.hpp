// describe.hpp - the lists that name every array of model and state.
#pragma once

#include <string>

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Masses of the nodes and the elements between them: part of `describe`.
template <class Visit>
void describe_bodies(Model& m, Visit&& field) {
  field("node.block", m.node_block);
  field("node.place", m.node_place);
  field("node.mass", m.mass);
  field("node.gravity_mass", m.gravity_mass);
  field("node.lumped_frequency_squared", m.lumped_frequency_squared);
  field("node.mass_row_first", m.mass_row_first);
  field("node.mass_axis_stride", m.mass_axis_stride);
  field("node.block_first", m.block_first);
  field("node.block_count", m.block_count);
  field("node.inverse_mass_bound", m.inverse_mass_bound);
  field("node.frequency_squared", m.frequency_squared);
  field("mass.inverse", m.mass_inverse);
  field("mass.matrix", m.mass_matrix);
  field("material.lambda", m.material_lambda);
  field("material.mu", m.material_mu);
  field("material.law", m.material_law);
  field("material.parameters", m.material_parameters);
  const auto elements = [&](const char* shape, ElementSet& e) {
    const std::string name = std::string(shape) + ".";
    field(name + "nodes", e.nodes);
    field(name + "material", e.material);
    field(name + "gradient", e.gradient);
    field(name + "volume", e.volume);
    field(name + "hourglass", e.hourglass);
  };
  elements("tet4", m.tet4);
  elements("pyramid5", m.pyramid5);
  elements("wedge6", m.wedge6);
  elements("hex8", m.hex8);
}

/// Exterior faces and edges, and pairs of faces: part of `describe`.
template <class Visit>
void describe_surfaces(Model& m, Visit&& field) {
  field("face.nodes", m.face_nodes);
  field("face.edges", m.face_edges);
  field("face.interface_class", m.face_interface_class);
  field("face.block", m.face_block);
  field("face.element", m.face_element);
  field("face.length", m.face_length);
  field("face.reach", m.face_reach);
  field("face.area", m.face_area);
  field("face.height", m.face_height);
  field("face.stiffness", m.face_stiffness);
  field("face.initially_exposed", m.face_initially_exposed);
  field("face.movable", m.face_movable);
  field("edge.nodes", m.edge_nodes);
  field("edge.faces", m.edge_faces);
  field("edge_star.first", m.edge_star_first);
  field("edge_star.node", m.edge_star);
  const auto pairs = [&](const char* kind, PairSet& p) {
    const std::string name = std::string(kind) + ".";
    field(name + "faces", p.faces);
    field(name + "nodes", p.nodes);
    field(name + "interface", p.interface);
    field(name + "area", p.area);
    field(name + "stiffness", p.stiffness);
    field(name + "point_first", p.point_first);
    field(name + "weights_a", p.weights_a);
    field(name + "weights_b", p.weights_b);
    field(name + "point_area", p.point_area);
  };
  pairs("triangles", m.triangles);
  pairs("quads", m.quads);
  pairs("overlaps", m.overlaps);
}

/// Visit every array that Python hands over, by name; the shapes are in cdem/build.py.
template <class Visit>
void describe(Model& m, Visit&& field) {
  describe_bodies(m, field);
  describe_surfaces(m, field);
  field("interface.of", m.interface_of);
  field("corner.first", m.corner_first);
  field("corner.row", m.corner);
  field("load.first", m.load_first);
  field("load.curve", m.load_curve);
  field("load.force", m.load_force);
  field("support.row", m.support);
  field("support.curve", m.support_curve);
  field("support.component", m.support_component);
  field("support.velocity", m.support_velocity);
}

/// What the search has built: part of `describe`.
template <class S, class Visit>
void describe_search(S& search, Visit&& field) {
  field("search.exposed_face", search.exposed_face, "faces that can be touched");
  field("search.face_exposed", search.face_exposed, "place of a face among them, or -1");
  field("outer.slot_first", search.outer.slot_first, "start of a vertex's candidates");
  field("outer.slot_faces", search.outer.slot_faces, "exposed faces that it may touch");
  field("outer.slot_pairs", search.outer.slot_pairs, "pairs of vertex and face they are of");
  field("outer.vf_pairs", search.outer.vf_pairs, "vertex and exposed face of a pair");
  field("outer.vf_bounds", search.outer.vf_bounds, "how far apart they may be in contact [m]");
  field("outer.acting_first", search.outer.acting_first, "start of a face's sources");
  field("outer.faces_acting_on", search.outer.faces_acting_on,
        "exposed faces whose contacts may act on it");
  field("outer.face_listed", search.outer.face_listed, "1: it may act on a face, or one on it");
  field("outer.ee_pairs", search.outer.ee_pairs,
        "pairs of edges that may touch: places of the two among the edges");
  field("outer.ee_codes", search.outer.ee_codes, "of which sides they are, which ends shared");
  field("outer.ee_sides", search.outer.ee_sides, "4 * exposed face + side of the faces at an edge");
  field("outer.edge_first", search.outer.edge_first, "start of an edge's pairs");
  field("outer.edge_pairs", search.outer.edge_pairs,
        "pairs that an edge is of, and the other edge");
  field("outer.ee_bounds", search.outer.ee_bounds,
        "how far apart they may begin to, see MarkNearEdges [m]");
  field("outer.rotation_soon", search.outer.rotation_soon,
        "how far an exposed face may soon turn [rad]");
  field("search.across", search.across, "face beyond a side of an exposed face, or -1");
  field("search.edge_star_first", search.edge_star_first, "start of a point's ring");
  field("search.edge_star", search.edge_star, "other ends of the edges that leave a point");
  field("search.contact_first", search.contact_first, "start of a node's contact rows");
  field("search.contact_corner", search.contact_corner,
        "contact rows of a node, of faces that are not idle");
  field("outer.predicted_nodes", search.outer.predicted_nodes,
        "nodes whose straying calls for a rebuild");
  field("outer.predicted", search.outer.predicted,
        "their position at the last, skin squared [m2], velocity foreseen, skin [m]");
}

/// Elements and bonded pairs: part of `describe`.
template <class S, class Visit>
void describe_sets(S& s, Visit&& field) {
  const auto elements = [&](const char* shape, auto& e) {
    const std::string name = std::string(shape) + ".";
    field(name + "point_stress", e.point_stress, "stress at Gauss points [Pa]");
    field(name + "energy", e.energy, "stored energy [J]");
    field(name + "damping_work", e.damping_work, "work of the stiffness dashpot [J]");
    field(name + "history", e.history, "inelastic strain and state of the laws at Gauss points");
    field(name + "plastic_work", e.plastic_work, "work of inelastic strain [J]");
  };
  elements("tet4", s.tet4);
  elements("pyramid5", s.pyramid5);
  elements("wedge6", s.wedge6);
  elements("hex8", s.hex8);

  const auto pairs = [&](const char* kind, auto& p) {
    const std::string name = std::string(kind) + ".";
    field(name + "live", p.live, "1 until released to the contact search, 2 as an open hinge");
    field(name + "bond", p.bond, "1 while intact, 0 once broken");
    field(name + "slip1", p.slip1, "plastic slip [m]");
    field(name + "slip2", p.slip2, "plastic slip [m]");
    field(name + "broken_tension", p.broken_tension, "springs broken in tension");
    field(name + "broken_shear", p.broken_shear, "springs broken in shear");
    field(name + "jump", p.jump, "change of a broken pair's largest jump since it broke [m]");
    field(name + "jump_at_break", p.jump_at_break, "that jump when it broke, or -1 [m]");
    field(name + "stored", p.stored, "elastic energy [J]");
    field(name + "fracture", p.fracture, "energy of fracture [J]");
    field(name + "friction", p.friction, "frictional work [J]");
    field(name + "history", p.history, "what the laws of the bond points remember");
  };
  pairs("triangles", s.triangles);
  pairs("quads", s.quads);
  pairs("overlaps", s.overlaps);
}

/// Contacts of semi-springs and semi-edges: part of `describe`.
template <class S, class Visit>
void describe_contacts(S& s, Visit&& field) {
  field("spring.target", s.springs.target, "exposed face in contact, or -1");
  field("spring.target_before", s.springs.target_before, "the same, one step ago");
  field("spring.state", s.springs.state,
        "normal force, penetration, shear forces, gap without stress, stored energies");
  field("spring.friction", s.springs.friction, "frictional work [J]");
  field("spring.dashpot", s.springs.dashpot, "work of the contact dashpot [J]");
  field("spring.reaction", s.springs.reaction, "force, stiffness, weights on the target");
  field("spring.lost", s.springs.lost, "1: lost by depth");
  field("spring.history", s.springs.history.rows, "what the laws at the vertices remember");
  field("spring.history_law", s.springs.history.law,
        "number of the law whose history it is, or -1");

  field("edge.first", s.edges.first, "place of a face's first contact");
  field("edge.contact", s.edges.contact,
        "4 * mother face + side, target face, target edge, place one step ago");
  field("edge.state", s.edges.state,
        "normal force, penetration, shear forces, gap without stress, stored energies");
  field("edge.reaction", s.edges.reaction,
        "force, stiffness, places on the edges, lost in the step");
  field("edge.friction", s.edges.friction, "frictional work [J]");
  field("edge.dashpot", s.edges.dashpot, "work of the contact dashpot [J]");
  field("edge.lost", s.edges.lost, "1: lost by depth");
  field("edge.history", s.edges.side_history.rows, "what the laws at the sides remember");
  field("edge.history_law", s.edges.side_history.law,
        "number of the law whose history it is, or -1");
}

/// Visit every array that must survive a restart, by name: checkpoint and Python views come from
/// it.
template <class S, class Visit>
void describe(S& s, Visit&& field) {
  field("node.motion", s.nodes.motion, "position [m], pad, velocity [m/s], pad");
  field("node.work_external", s.nodes.work_external, "work of loads and supports [J]");
  field("node.work_damping", s.nodes.work_damping, "work taken out by damping [J]");
  field("node.reaction", s.nodes.reaction, "force of supports [N]");
  field("node.relax", s.nodes.relax, "force and velocity of the last step, adaptive relaxation");
  field("node.relax_mass", s.nodes.relax_mass, "scaled masses of adaptive relaxation [kg]");
  field("node.bonded_node", s.nodes.bonded_node,
        "label shared by nodes that intact bonds hold together");
  describe_sets(s, field);
  describe_contacts(s, field);
  describe_search(s.search, field);
}

}  // namespace cdem
