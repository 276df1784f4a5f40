// surface_rows.hpp - kernels that find the surface around bodies: edges that leave a point, and the
// face beyond a side.
#pragma once

#include "core/base/parallel.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

/// Flag the nodes of exposed faces, and the labels of these nodes.
struct MarkExposedPoints {
  const Index *exposed_face, *face_nodes, *bonded_node;
  Flag *exposed, *wanted;  // [node], [label]

  CDEM_HD void operator()(One x) const {
    const Index* const nodes = face_nodes + 4 * std::size_t(exposed_face[x.i]);
    for (Index k = 0; k < 4; ++k)
      if (nodes[k] >= 0) set(exposed[nodes[k]]), set(wanted[bonded_node[nodes[k]]]);
  }
};

/// Edges of the nodes of wanted points, by point, see list_rows: in the order of the labels of
/// their ends, of one label first those that end at exposed faces, then by node.
struct EdgesOfPoints {
  const Index *own_first, *own;  // [node + 1] other ends of the edges of a node
  const Index* bonded_node;
  const Flag *exposed, *wanted;

  template <class Act>
  CDEM_HD void visit(One node, const Act& act) const {
    const Index label = bonded_node[node.i];
    if (!wanted[label]) return;
    for (Index edge = own_first[node.i]; edge < own_first[node.i + 1]; ++edge) act(label, edge);
  }
  CDEM_HD bool is_before(Index edge, Index other) const {
    const Index a = own[edge], b = own[other];
    if (bonded_node[a] != bonded_node[b]) return bonded_node[a] < bonded_node[b];
    return exposed[a] != exposed[b] ? exposed[a] > exposed[b] : a < b;
  }
};

/// Of these the ends, one of a label, see list_items.
struct EndsOfPoints {
  const Index *first, *edges;  // [label + 1], see EdgesOfPoints
  const Index *own, *bonded_node;

  template <class Act>
  CDEM_HD void visit(One label, const Act& act) const {
    Index before = -1;
    for (Index c = first[label.i]; c < first[label.i + 1]; ++c) {
      const Index end = own[edges[c]];
      if (bonded_node[end] != before) act(end);
      before = bonded_node[end];
    }
  }
};

/// The faces of live conforming pairs find each other.
struct FindMates {
  const Flag* status;
  const Index* faces;  // [pair][2]
  Index* mate;         // [face], initially -1

  CDEM_HD void operator()(One pair) const {
    if (!is_live(PairStatus(status[pair.i]))) return;
    const Index* const of = faces + 2 * std::size_t(pair.i);
    mate[of[0]] = of[1];
    mate[of[1]] = of[0];
  }
};

/// The face beyond a side of an exposed face: walk through the bodies that meet there, from each
/// into the next that is bonded to it along the side, until a face is in the open. -1: there is
/// none, or a triangle has no such side.
struct FindAcross {
  const Index *exposed_face, *face_exposed;   // [exposed], [face]
  const Index *face_nodes, *face_edges;       // [face][4]
  const Index *edge_nodes, *edge_faces;       // [edge][2]
  const Index *bonded_node, *mate;            // [node], [face], see FindMates
  Index* across;                              // [exposed][4]
  static constexpr Index most_bodies = 1000;  // around one edge

  CDEM_HD void operator()(One slot) const {
    const Index face = exposed_face[slot.i / 4], side = slot.i % 4;
    across[slot.i] = side < vertex_count(face) ? beyond(face, side) : -1;
  }

 private:
  CDEM_HD Index beyond(Index face, Index side) const {
    Index beyond = -1;
    for (Index body = 0; body < most_bodies; ++body) {
      const Index edge = face_edges[4 * std::size_t(face) + side];
      const Index* const of = edge_faces + 2 * std::size_t(edge);
      beyond = of[of[0] == face ? 1 : 0];
      if (beyond < 0 || face_exposed[beyond] >= 0 || mate[beyond] < 0) break;
      face = mate[beyond];
      side = side_along(face, edge);
      if (side < 0) break;  // the bond is broken there
    }
    return beyond;
  }
  CDEM_HD Index vertex_count(Index face) const {
    return face_nodes[4 * std::size_t(face) + 3] < 0 ? 3 : 4;
  }
  CDEM_HD Index point(Index face, Index k) const {
    return bonded_node[face_nodes[4 * std::size_t(face) + k]];
  }
  /// Side of a face between the same two points as an edge, or -1.
  CDEM_HD Index side_along(Index face, Index edge) const {
    const Index* const ends = edge_nodes + 2 * std::size_t(edge);
    const Index a = bonded_node[ends[0]], b = bonded_node[ends[1]], count = vertex_count(face);
    for (Index k = 0; k < count; ++k) {
      const Index u = point(face, k), v = point(face, k + 1 < count ? k + 1 : 0);
      if ((u == a && v == b) || (u == b && v == a)) return k;
    }
    return -1;
  }
};

}  // namespace cdem
