// state.hpp - data that a step changes.
#pragma once

#include <vector>

#include "core/base/answer.hpp"
#include "core/base/column.hpp"
#include "core/base/short_numbers.hpp"
#include "core/model/modules.hpp"
#include "core/model/share.hpp"
#include "core/records/contact_records.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

struct NodeState {
  Column<Real> motion;  // rows of 8: position, velocity
  Column<Real> work_external, work_damping;
  Column<Real> step_change;              // energy that changes of the step hide
  Column<Real> force, reaction, sample;  // rows of 4
  Column<Real> damping_force;            // rows of 4, empty until something damps
  Column<Real> unbalance;
  Column<Real> peak;         // largest squared speed, see KeepPeak; empty: nothing asks for it
  bool keeps_peaks = false;  // in this stage
  Column<Real> relax;       // adaptive relaxation only, rows of 8: force, velocity of the last step
  Column<Real> relax_mass;  // and only then not empty: masses that move, scaled  [kg]
  Column<Index> bonded_node, body;  // labels, see bonds/bonded_surface.hpp
  Column<Index> awake;              // blocks of nodes, see nodes/sleep.hpp
  Column<Flag> sleeps, listed;      // see nodes/sleep.hpp
  Column<Flag> lumped;              // 1: its block has bonds, see list_lumped; empty: none has
  Column<Flag> out;                 // 1: taken out, see run/take_out.hpp; empty: none is
  Column<Real> relief;              // rows of 4, see run/excavate.hpp; empty: none
  Column<Real> applied;             // rows of 4, sum of several modules; empty where one is there
  Column<Flag> has_applied;  // 1: modules apply forces to it, see nodes/applied.hpp; or empty
  Column<Real> radiated, radiated_sample;  // work of dashpots, see SampleDashpots; or empty
  Column<Flag> fused;     // 1: of a fused block, see nodes/fused_block.hpp; empty: there is none
  Column<Index> general;  // awake blocks of nodes, without completely fused ones
  bool damped = false;    // in the last step, else damping_force does not count
  Column<Index> element_first, element_corner;  // see list_element_corners
  Column<Index> tile_first;                     // rows of tiles that a node sums, see ElementTiles
  Column<Index> corner_first, corner;           // rows of live pairs and modules that it sums then
};

/// Dashpots between nodes and the ground, see nodes/ground.hpp; empty where there are none.
struct GroundState {
  Column<Index> row, node;  // [node] row or -1, and node of each row
  Column<Real> matrix;      // rows of 8, see Dashpots  [kg/s]
  Column<Real> force;       // rows of 4, made in every step  [N]
};

/// Blocks of elements, all fused and with full mass matrices, see
/// nodes/fused_block.hpp, those fused with lumped masses, and the other blocks that are awake.
struct FusedBlocks {
  Column<Index> blocks, general;
  Column<Index> lumped;          // blocks with lumped masses
  Column<Index> row_first, row;  // see FusedRows
};

/// Tiles of a set: consecutive blocks of elements that have few nodes together. A tile sums the
/// forces of its elements on each of its nodes and puts them into a row, see elements/tiles.hpp.
struct ElementTiles {
  Column<Index> block_first;  // [tile + 1] blocks of elements
  Column<Index> node_first;   // [block + 1] nodes that come to the tile with a block
  Column<Index> node, row;    // these nodes, and their rows: rows of a node are contiguous
  Column<Index> place;        // [corner][element] of its node among the tile's nodes
  // On a GPU: [tile node + 1] and the corners at it, by element, counted from the first of the tile
  Column<Index> corner_first, corner;
};

struct ElementState {
  ElementTiles tiles;
  Column<Real> stress;        // mean, for output: [6][element]
  Column<Real> point_stress;  // incremental formulations: [point * 6][element]
  Column<Real> energy, damping_work;
  Column<Real> branch, dashpot;  // see RockDamping; empty where a stage does not damp so
  Column<Real> history;          // [point * point_history][element], see PointFlow; may be empty
  Column<Real> plastic_work;     // empty where no material of the set flows
  Column<Real> yielded;          // for output, see yield_bit; empty where plastic_work is
  Column<Index> awake;           // blocks of elements, see nodes/sleep.hpp
  FusedBlocks fused;
};

/// Dilatation of tets that is averaged at their nodes, see elements/nodal_mean.hpp; empty where
/// none is.
struct NodalMeans {
  Column<Real> start;        // [tet] its initial value
  Column<Real> after;        // [node] mean of changes since, after the last step
  Column<Real> own, flowed;  // [tet] made in every step
  Column<Real> trial;        // [node] the same
  Column<Index> blocks, other_blocks, nodes;
  Column<Index> tet_first, tet;  // tets of a node
};

/// State of interface laws at the walls of contacts, see interfaces/history.hpp.
struct HistoryColumns {
  Index width = 0;  // numbers of a row; 0 where no law of the model has state
  Column<Real> rows;
  Column<Index> law;
};

struct PairState {
  Column<Flag> status;  // PairStatus
  Column<Real> bond, slip1, slip2, broken_tension, broken_shear, jump, jump_at_break;
  Column<Real> rest;  // [axis * points + point][pair], see PairColumns; empty: all zero
  Column<Real> rise;  // [point][pair] the same
  Column<Real> stored, fracture, friction;
  Column<Real> dashpot, damping_work;  // see BondDashpots; empty where a stage does not damp so
  Column<Real> history;                // [variable * points + point][pair], of the pair's law
  Index history_width = 0;             // variables of a point; 0 where no law has state
  Column<Index> awake;                 // blocks of pairs, see nodes/sleep.hpp
};

struct SpringState {
  Column<Index> target, target_before;
  Column<Real> state, reaction;  // rows of 8
  Column<Real> friction, dashpot, rim_action;
  Column<Flag> lost, unresolved;
  HistoryColumns history;  // [slot]
  Column<Real> rolling;    // rows of 8 of RollingState; empty where no interface resists rolling
};

/// Contacts of semi-edges, see EdgeColumns; every step makes the list from the one before.
struct EdgeState {
  Column<Index> first, contact;    // [exposed + 1], rows of 4
  Column<Real> state, reaction;    // rows of 8
  Column<Real> friction, dashpot;  // [exposed]
  Column<Flag> lost;               // [exposed]
  HistoryColumns side_history;     // [4 * exposed face + side]
  HistoryColumns contact_history;  // [contact], made in every step
  Column<Index> old_first, old_contact;
  Column<Real> old_state;
  Column<Index> found, seen;  // [contact] see FoundEdges, ListEdgeContacts
};

/// Contacts by the exposed face that they act on, see contact/force/accumulate.hpp; made in every
/// step.
struct ContactsByTargetState {
  Column<Index> first, contact;
};

/// Areas of contacts, where a law asks for them, see contact/force/contact_area.hpp; made in every
/// step.
struct ContactAreasState {
  Column<Real> touching;       // rows of 4 of TouchingFace
  Column<Real> per_stiffness;  // [exposed]
};

/// Outer pair list: possible contacts before the next rebuild, see
/// contact/pair_list/outer_list.hpp.
/// A slot is 4 * exposed face + vertex; vf is a pair of vertex and face, ee one of two edges.
struct OuterList {
  Real lookahead_time = 0, built_time = 0;  // how long it holds at most, and from when  [s]
  Real least_skin = 0.001;                  // of a node, in parts of L; follows how long it lasts
  bool skin_exceeded = false;               // a node left its skin: the list is too old
  Column<Index> slot_first, slot_pairs;     // by slot: pairs of vertex and face, by the face
  Column<Index> vf_pairs;                   // [2][pair] node, exposed face
  Column<Short> vf_bounds;                  // [6][pair] see MarkNearFaces
  Column<Index> ee_pairs, ee_codes;         // [2][pair], [pair], see ListedEdges
  Column<Index> ee_sides, ee_edges;         // [edge][2], [edge] the same
  Column<Short> ee_bounds;                  // [6][pair] see MarkNearEdges
  Column<Index> edge_first, edge_pairs;     // by edge of the mesh, see PairsOfEdges
  Column<Real> rotation_soon;               // [exposed] see ListedFaces
  Column<Index> acting_first, faces_acting_on;    // by face: those whose contacts may act on it,
                                                  // where a law asks for areas, else empty
  Column<Flag> face_listed;                       // [exposed] may it act on any, or any on it?
  Column<Index> predicted_nodes, node_predicted;  // nodes of exposed faces; node -> place or -1
  Column<Real> predicted;                         // rows of 8 of theirs, see PredictedNode
};

/// Inner pair list: pairs of the outer list that can come into contact within the next few steps,
/// see contact/pair_list/inner_list.hpp. It follows from the outer list, whenever it is made.
struct InnerList {
  bool known = false;          // made since the outer list was
  bool skin_exceeded = false;  // a node left its skin: the list is too old
  Real built_time = 0;
  Column<Real> predicted, skin;  // rows of 8, see PredictedNode; [node]  [m]
  Column<Short> motion;          // [outer pair] see MarkNearFaces
  Column<Flag> faces, edges;     // [outer pair] are they near?
  Column<Flag> candidates;       // [outer slot face] is it near?
  Column<Index> first, count;    // by slot
  Column<Index> candidate;       // exposed faces
  Column<Flag> rises;            // [candidate] may the surface rise at a side of it?
  Column<Flag> may_begin;        // [candidate] see FilterNewTargets; made in every step
  Column<Index> near_edges;      // outer pairs of edges
  Column<Index> edge_ends, edge_sides, edge_codes, edge_of;  // of its pairs of edges, see EdgePairs
  Column<Flag> open;        // [inner pair] see FilterEdgePairs; made in every step
  Column<Index> held;       // of its pairs of edges, see EdgePairs
  bool held_known = false;  // in the last step, and neither pairs nor contacts were moved since
};

/// What the coming step begins with: flags.
struct Due {
  Flag release = 0;  // a broken pair has moved far
  Flag outer = 0;    // a node has left its skin of the outer pair list
  Flag inner = 0;    // and of the inner one
};

/// Exposed faces, the surface that they make, and the pair lists.
struct SearchState {
  Column<Index> exposed_face, face_exposed;  // place -> face, face -> place or -1
  Column<ExposedRow> exposed;                // data derived from them, see list_exposed
  Index joined_faces = -1;  // exposed faces, and intact bond points, as join_surfaces last saw them
  Real joined_points = -1;
  Column<Index> across;                      // side of an exposed face -> face beyond it, or -1
  Column<Index> edge_star_first, edge_star;  // bonded node -> other ends of the edges that leave it
  Column<Index> contact_first, contact_corner;  // node -> corner rows of exposed faces
  OuterList outer;
  InnerList inner;
  Answer<Due> due;
  std::int64_t asked_step = -1;    // before which step that was asked; -1: it was not
  std::int64_t decided_step = -1;  // before which step a rebuild was decided on; -1: none was
  bool rebuild_is_due = false;     // what was decided
};

/// Categories of the wall time of steps.
enum class Phase { rebuild, search, contact, element, node };

/// Release of removed blocks: the remaining fraction of their forces, over time.
struct Relief {
  Real begin = 0, end = 0;  // [s]
  Real from = 1, to = 1;    // part that is left at these times
  Real part = 1;            // in this step

  Real at(Real time) const {
    if (!(time < end)) return to;
    return time > begin ? from + (to - from) * (time - begin) / (end - begin) : from;
  }
};

struct State {
  Share share;           // of a rank; not part of the results
  Real seconds[5] = {};  // wall time so far by Phase; not part of the results
  Real time = 0;
  Real loads_time = 0;       // of load_factor and velocity_factor  [s]
  Real dt = 0, dt_last = 0;  // of the coming and of the last step  [s]
  Real dt_stable = 0;        // which `dt` grows towards  [s]
  std::int64_t step = 0, rebuilds = 0, built_step = -1;
  Real energy_start = 0, energy_scale = 0;  // of the ledger
  Real stopped_energy = 0;                  // kinetic energy taken out by kinetic relaxation  [J]
  Real taken_out = 0;                       // stored energy of removed blocks  [J]
  Real taken_out_friction = 0;              // loss of contacts on their faces until then  [J]
  Real taken_out_dashpot = 0;               // and in their dashpots  [J]
  Real kinetic_peak = 0;                    // since the motion was last stopped  [J]
  bool stop_due = false;                    // kinetic relaxation: stop all motion in the next step
  Real relax_damping = 0;  // mass damping that adaptive relaxation has found  [1/s]
  Index missed = 0;        // contacts that an all-pairs search found and ours did not
  bool ledger_started = false;
  Relief relief;
  NodeState nodes;
  GroundState ground;
  ElementState tet4, pyramid5, wedge6, hex8;
  NodalMeans nodal;
  Column<Real> moduli;  // of the rock over those of its materials; empty: the same
  PairState triangles, quads, overlaps;
  Modules::Data<StatePart> modules;
  Column<Index> released_overlaps;  // their contacts are still to be found in this step
  SpringState springs;
  EdgeState edges;
  ContactsByTargetState contacts_by_target;
  ContactAreasState contact_areas;
  SearchState search;
  Column<Real> tile_force, corner_force;      // rows of 4: of tiles; of pairs and modules
  Column<Real> face_geometry, contact_force;  // rows of 8, 4
  Column<Real> node_potential, node_bonds;    // stiffness that contacts may have, bonds have  [N/m]
  Column<Real> load_factor, velocity_factor;  // of the curves in this step
  std::vector<Real> known_load_factor, known_velocity_factor;  // the same, for the host
};

/// Does a pair list name anything?
inline bool names_pairs(const OuterList& outer) {
  return outer.slot_pairs.size() > 0 || outer.ee_codes.size() > 0 ||
         outer.faces_acting_on.size() > 0;
}
/// Does the present one? Without it contacts only end, in the first step with it.
inline bool has_contact_pairs(const State& s) {
  return names_pairs(s.search.outer) || s.built_step == s.step;
}

}  // namespace cdem
