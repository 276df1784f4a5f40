// model.hpp - constant during a step: mesh, topology, properties, rules.
#pragma once

#include <vector>

#include "core/base/column.hpp"
#include "core/base/math.hpp"
#include "core/model/modules.hpp"
#include "core/records/interface.hpp"
#include "core/records/rules.hpp"

namespace cdem {

enum class Formulation { corotational, incremental, paper_incremental, paper_total };

/// Elements of one shape: tables with one row per corner, gradient component or Gauss point.
struct ElementSet {
  Index count = 0, stride = 0;
  Index corners = 0, points = 0;  // nodes and Gauss points of an element
  Index corner_first = 0;         // corners of the sets before
  Column<Index> nodes, material;
  Column<Real> gradient, volume;
  Column<Real> hourglass;   // of hexahedra with one point, else empty
  Column<Real> values;      // [point][corner] of the shape functions; empty: no rock has pores
  Column<Flag> nodal_mean;  // of tets, 1: see elements/nodal_mean.hpp; empty: none
};

/// Bonded pairs of one kind: conforming triangles, conforming quadrilaterals, or overlaps.
struct PairSet {
  Index count = 0, stride = 0;
  Index points = 0, point_stride = 0;   // rows of point tables, and their stride
  Index corner_first = 0, corners = 0;  // rows among the corner forces, and how many a pair has
  Column<Index> faces;                  // [pair][2]
  Column<Index> nodes;                  // conforming: [2 * vertices][pair]
  Column<Index> interface;              // [pair]
  Column<Real> area, stiffness;
  Column<Real> strength;      // factor on the strength of a pair; empty: all 1
  Column<Index> point_first;  // overlaps: [pair + 1]
  Column<Real> weights_a, weights_b, point_area;
};

/// Do the faces of the pairs share their vertices? Else they overlap.
inline bool conforms(const PairSet& p) { return p.point_first.size() == 0; }

/// Numbers of a model that are no arrays of rows: all parts of it have the same.
struct Settings {
  Vec3<Real> gravity{0, 0, 0};
  std::vector<std::vector<Real>> curve_time, curve_factor;
  InterfaceTraits interface_traits;  // properties of the interfaces for a step, see note_interfaces
  Formulation formulation = Formulation::corotational;
  SearchRules rules;
  Real bond_indentation_triangle = 0, bond_indentation_quad = 0;
  bool semi_edges = true;
  bool check_search = false;   // compare every search with an all-pairs search
  Index rebuild_interval = 0;  // 0: by displacement; else the paper's every so many steps
  NodeDamping damping{0, 0};
  bool initial_stress = false;       // does the rock begin under stress?
  bool loose_pairs = false;          // do joints without strength begin as pairs, broken?
  Real initial_lift = 0;             // of rules.lifted, for initial tractions  [m]
  bool lumped = false;               // lumped masses for all: quicker to rest, wrong inertia
  bool lumped_while_bonded = false;  // lumped masses for blocks with bonds, see list_lumped
  Real stiffness_damping = 0;        // Rayleigh, fraction of critical at the stability limit
  Real damping_time = 0;             // Rayleigh, of elements and of bonds that hold  [s]
  MaxwellBranches maxwell;
  Real contact_damping = 0;  // fraction of critical
  Real step_safety = 0.8;
  Real step_given = 0;   // 0: automatic
  Real speed_limit = 0;  // faster than this the run has gone wrong  [m/s]
};

struct Model : Settings {
  // nodes
  Index node_count = 0;
  Column<Index> node_block, node_place;
  Column<Real> mass, gravity_mass;
  Column<Index> mass_row_first, mass_axis_stride, block_first, block_count;
  Column<Real> mass_inverse, mass_matrix;
  Column<Real> inverse_mass_bound;        // largest eigenvalue of the inverse mass matrix  [1/kg]
  Column<Real> least_mass;                // diagonal below the mass matrix  [kg]; empty: not known
  Column<Real> frequency_squared;         // bound from the node's elements, squared  [1/s2]
  Column<Real> lumped_frequency_squared;  // the same with lumped masses

  ElementSet tet4, pyramid5, wedge6, hex8;
  Column<Real> material_lambda, material_mu;
  Column<Index> material_law;        // number in BlockLaws
  Column<Real> material_parameters;  // [material][law_numbers]

  // exterior faces and edges
  Index face_count = 0, edge_count = 0;
  Column<Index> face_nodes, face_edges, face_interface_class, face_block, face_element;
  Column<Real> face_length, face_reach, face_area, face_height, face_stiffness, face_radius;
  Column<Index> edge_nodes, edge_faces, edge_star_first, edge_star;
  Column<Flag> face_initially_exposed, face_movable;
  Column<Index> flush_first, flush_face;  // faces of other blocks that began flush with a face
  Column<Flag> node_flush;                // has one of the faces at a node any?

  // interfaces
  PairSet triangles, quads, overlaps;
  Index class_count = 0;
  Column<Index> interface_of;
  Column<Interface> interfaces;
  Column<Real> interface_parameters;  // [interface][parameter_row]

  Modules::Data<GivenPart> modules;

  // corner rows of pairs and modules at each node; ~row if it takes the negative
  // of that row
  Index corner_rows = 0;
  Column<Index> corner_first, corner;

  // loads and supports
  Column<Index> load_first, load_curve;
  Column<Real> load_force;
  Column<Index> support, support_curve;
  Column<Flag> support_component;
  Column<Real> support_velocity;
};

}  // namespace cdem
