// give_history.hpp - kernel that gives the states of laws from bond points to the walls of faces.
#pragma once

#include "core/bonds/pair_sides.hpp"
#include "core/interfaces/history.hpp"

namespace cdem {

/// Where the bond points of pairs lie on their faces.
struct PointsOnFaces {
  const Index* face_nodes;   // [face][4], the fourth is -1 for a triangle
  InIndices nodes;           // conforming: [2 * points][pair]
  Index points, stride;      // rows of the point tables, and their stride
  const Index* point_first;  // overlaps: [pair + 1]; else null
  const Real* weights[2];    // overlaps: [point][4] on the vertices of either face
  const Real* point_area;    // overlaps  [m2]

  CDEM_HD Index vertex_count(Index face) const { return face_nodes[4 * face + 3] < 0 ? 3 : 4; }
  /// Call act(place in the point tables, weight) for the points that bear on a vertex of a face,
  /// which is that `side` of the pair.
  template <class Act>
  CDEM_HD void each(Index pair, Index side, Index face, Index vertex, const Act& act) const {
    if (point_first) {
      for (Index c = point_first[pair]; c < point_first[pair + 1]; ++c)
        act(std::size_t(c), point_area[c] * abs_of(weights[side][4 * c + vertex]));
      return;
    }
    const Index node = face_nodes[4 * face + vertex];
    for (Index k = 0; k < points; ++k)
      if (nodes.at(side * points + k, pair) == node) act(std::size_t(k) * stride + pair, Real(1));
  }
};

/// Give the vertices and sides of an exposed face the states of the laws of its bond points; item:
/// exposed face.
struct GiveHistory {
  PairSides sides;
  const Index *first, *rows;  // sides by exposed face
  PointsOnFaces points;
  const Index* interface;  // [pair]
  const Interface* interfaces;
  const Real* remembered;       // [variable * points + point][pair]
  HistoryRows vertices, edges;  // [4 * exposed face + vertex or side]

  static constexpr Index width = HistoryRows::width;

  CDEM_HD void operator()(One x) const {
    for (Index r = first[x.i]; r < first[x.i + 1]; ++r) give(x.i, rows[r]);
  }

 private:
  CDEM_HD void give(Index exposed, Index side) const {
    const Index face = sides.face(side), pair = sides.pair(side);
    const Index law = interfaces[interface[pair]].law;
    const Index count = points.vertex_count(face), slot = 4 * exposed;
    for (Index v = 0; v < count; ++v) give_to_vertex(pair, side % 2, face, v, slot + v, law);
    for (Index v = 0; v < count; ++v) {
      const Index end = v + 1 == count ? 0 : v + 1;
      for (Index k = 0; k < width; ++k)
        row(edges, slot + v)[k] = 0.5 * (row(vertices, slot + v)[k] + row(vertices, slot + end)[k]);
      edges.law[slot + v] = law;
    }
  }
  /// The state of its point, or the mean of the points by their weights on it.
  CDEM_HD void give_to_vertex(Index pair, Index side, Index face, Index vertex, Index slot,
                              Index law) const {
    Real total = 0;
    points.each(pair, side, face, vertex, [&](std::size_t, Real weight) { total += weight; });
    if (!(total > 0)) return;
    const std::size_t stride = std::size_t(points.points) * points.stride;
    for (Index k = 0; k < width; ++k) {
      Real sum = 0;
      points.each(pair, side, face, vertex, [&](std::size_t place, Real weight) {
        sum += weight * remembered[k * stride + place];
      });
      row(vertices, slot)[k] = sum / total;
    }
    vertices.law[slot] = law;
  }
  CDEM_HD static Real* row(const HistoryRows& h, Index place) {
    return h.rows + std::size_t(place) * width;
  }
};

}  // namespace cdem
