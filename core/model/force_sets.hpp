// force_sets.hpp - the sets of elements, bonded pairs and bolts, each once, and what loops ask of
// them.
//
// Whatever puts forces on nodes through tiles or corner rows is a set. All loops over sets come
// from here: a new set is named here, with overloads of what is asked of it below, and has its
// kernels.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/bolt_states.hpp"
#include "core/records/energy_terms.hpp"

namespace cdem {

// What chooses the kernels of a set; defined in elements/shapes.hpp and bonds/bonded_pairs.hpp.
struct Tet4;
struct Pyramid5;
struct Wedge6;
struct Hex8;
struct Hex8OnePoint;
template <Index count>
struct ConformingBonds;
struct OverlapBonds;

/// A kind of elements: its name, and how many nodes and Gauss points an element has.
template <class Shape>
struct ElementKind {
  const char* name;
  Index corners, points;
};

/// A kind of bonded pairs: its name, how many rows the point tables have, and how many corner rows
/// a pair has.
template <class Bonds>
struct PairKind {
  const char* name;
  Index points, corners;
};

/// Bolts: their name, and how many nodes of the rock a point lies between.
struct BoltKind {
  const char* name;
  Index points, corners;
};

/// Call visit(kind, set, state) for every set of elements.
template <class M, class S, class Visit>
void for_each_element_set(M& m, S& s, Visit&& visit) {
  visit(ElementKind<Tet4>{.name = "tet4", .corners = 4, .points = 1}, m.tet4, s.tet4);
  visit(ElementKind<Pyramid5>{.name = "pyramid5", .corners = 5, .points = 5}, m.pyramid5,
        s.pyramid5);
  visit(ElementKind<Wedge6>{.name = "wedge6", .corners = 6, .points = 6}, m.wedge6, s.wedge6);
  if (m.hex8.hourglass.size() > 0)
    visit(ElementKind<Hex8OnePoint>{.name = "hex8", .corners = 8, .points = 1}, m.hex8, s.hex8);
  else
    visit(ElementKind<Hex8>{.name = "hex8", .corners = 8, .points = 8}, m.hex8, s.hex8);
}

/// The same for every set of bonded pairs.
template <class M, class S, class Visit>
void for_each_pair_set(M& m, S& s, Visit&& visit) {
  visit(PairKind<ConformingBonds<3>>{.name = "triangles", .points = 3, .corners = 3}, m.triangles,
        s.triangles);
  visit(PairKind<ConformingBonds<4>>{.name = "quads", .points = 4, .corners = 4}, m.quads, s.quads);
  visit(PairKind<OverlapBonds>{.name = "overlaps", .points = 1, .corners = 8}, m.overlaps,
        s.overlaps);
}

/// The same for the sets that put forces on nodes through corner rows, in the order of these.
template <class M, class S, class Visit>
void for_each_row_set(M& m, S& s, Visit&& visit) {
  for_each_pair_set(m, s, visit);
  visit(BoltKind{.name = "bolts", .points = 0, .corners = 8}, m.bolts, s.bolts);
}

/// The same for all sets: elements put their forces on nodes through tiles.
template <class M, class S, class Visit>
void for_each_set(M& m, S& s, Visit&& visit) {
  for_each_element_set(m, s, visit);
  for_each_row_set(m, s, visit);
}

/// Nodes, and points, of all bolts.
inline Index bolt_node_count(const BoltSet& b) {
  return b.first.size() > 0 ? b.first[b.first.size() - 1] : 0;
}
inline Index bolt_point_count(const BoltSet& b) { return Index(b.stiffness.size()); }

/// Do the faces of the pairs share their vertices? Else they overlap.
inline bool conforms(const PairSet& p) { return p.point_first.size() == 0; }

/// Does an item act on its nodes? Pairs do until they are released.
inline bool is_active(const PairState& s, Index pair) {
  return is_live(PairStatus(s.status[pair]));
}

/// A bolt does while it is installed.
inline bool is_active(const BoltState& s, Index bolt) {
  const BoltPhase phase = BoltPhase(s.phase[bolt]);
  return phase == BoltPhase::placed || phase == BoltPhase::acting;
}

/// Call visit(point) for the points of a bolt.
template <class Visit>
void for_each_point(const BoltSet& b, Index bolt, Visit&& visit) {
  for (Index n = b.first[bolt]; n < b.first[bolt + 1]; ++n) visit(n);
  const Index nodes = bolt_node_count(b);
  for (Index c = 2 * b.crossing_first[bolt]; c < 2 * b.crossing_first[bolt + 1]; ++c)
    visit(nodes + c);
}

/// Call visit(row) for the corner rows of an item.
template <class Set, class Visit>
void for_each_corner_row(const Set& set, Index item, Visit&& visit) {
  const Index first = set.corner_first + item * set.corners;
  for (Index row = first; row < first + set.corners; ++row) visit(row);
}
template <class Visit>
void for_each_corner_row(const BoltSet& b, Index bolt, Visit&& visit) {
  for_each_point(b, bolt, [&](Index p) {
    for (Index k = 0; k < b.corners; ++k) visit(b.corner_first + p * b.corners + k);
  });
}

/// Corners of all elements together.
inline Index element_corner_count(const Model& m, const State& s) {
  Index count = 0;
  for_each_element_set(
      m, s, [&](auto, const ElementSet& e, const ElementState&) { count += e.count * e.corners; });
  return count;
}

/// Call visit(node) for the nodes of an item.
template <class Visit>
void for_each_node(const Model&, const ElementSet& e, Index item, Visit&& visit) {
  for (Index k = 0; k < e.corners; ++k) visit(e.nodes[std::size_t(k) * e.stride + item]);
}
template <class Visit>
void for_each_node(const Model& m, const PairSet& p, Index pair, Visit&& visit) {
  if (conforms(p)) {
    for (Index k = 0; k < 2 * p.points; ++k) visit(p.nodes[std::size_t(k) * p.stride + pair]);
    return;
  }
  for (Index k = 0; k < 8; ++k) {
    const Index node = m.face_nodes[4 * p.faces[2 * pair + k / 4] + k % 4];
    if (node >= 0) visit(node);  // a triangle has no fourth
  }
}

template <class Visit>
void for_each_node(const Model&, const BoltSet& b, Index bolt, Visit&& visit) {
  for_each_point(b, bolt, [&](Index p) {
    for (Index k = p * b.corners; k < (p + 1) * b.corners; ++k)
      if (b.hosts[k] >= 0) visit(b.hosts[k]);
  });
}

/// Call visit(node, stiffness [N/m]) for what an item stiffens its nodes by at most: from it comes
/// the bound of their frequencies. That of elements is in the model already.
template <class Visit>
void for_each_stiffness(const Model& m, const PairSet& p, Index pair, Visit&& visit) {
  const Real k = std::max(p.stiffness[pair], p.stiffness[std::size_t(p.stride) + pair]);
  if (conforms(p)) {
    const Real share = k * p.area[pair] / p.points;
    for_each_node(m, p, pair, [&](Index node) { visit(node, share); });
    return;
  }
  for (Index c = p.point_first[pair]; c < p.point_first[pair + 1]; ++c)
    for (Index v = 0; v < 4; ++v) {
      const Index a = m.face_nodes[4 * p.faces[2 * pair] + v];
      const Index b = m.face_nodes[4 * p.faces[2 * pair + 1] + v];
      if (a >= 0) visit(a, k * p.point_area[c] * std::abs(p.weights_a[4 * c + v]));
      if (b >= 0) visit(b, k * p.point_area[c] * std::abs(p.weights_b[4 * c + v]));
    }
}

template <class Visit>
void for_each_stiffness(const Model&, const BoltSet& b, Index bolt, Visit&& visit) {
  for_each_point(b, bolt, [&](Index p) {
    for (Index k = p * b.corners; k < (p + 1) * b.corners; ++k)
      if (b.hosts[k] >= 0) visit(b.hosts[k], b.stiffness[p] * std::abs(b.weights[k]));
  });
}

/// Call visit(term, column) for the columns that the terms of the energy ledger sum, see
/// energy_term.
template <class Visit>
void for_each_energy(const ElementState& s, Visit&& visit) {
  visit(energy_term("strain"), s.energy);
  visit(energy_term("damping"), s.damping_work);
  visit(energy_term("plastic"), s.plastic_work);
}
template <class Visit>
void for_each_energy(const PairState& s, Visit&& visit) {
  visit(energy_term("contact"), s.stored);
  visit(energy_term("friction"), s.friction);
  visit(energy_term("fracture"), s.fracture);
}
template <class Visit>
void for_each_energy(const BoltState& s, Visit&& visit) {
  visit(energy_term("bolts"), s.stored);
  visit(energy_term("bolt_loss"), s.lost);
  visit(energy_term("external"), s.jacked);
}

}  // namespace cdem
