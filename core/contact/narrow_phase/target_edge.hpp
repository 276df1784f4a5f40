// target_edge.hpp - which edges a semi-edge crosses. Feng et al. (2014), Eq. 10-12.
#pragma once

#include <bit>

#include "core/base/parallel.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/geometry/face_interfaces.hpp"
#include "core/contact/narrow_phase/closed_contact.hpp"
#include "core/contact/narrow_phase/touching_edges.hpp"

namespace cdem {

/// Contacts that the search finds in a step, by mother face and in any order: `slots` places a
/// face. A face may cross more edges than that; its count says so, and the caller makes room.
struct FoundEdges {
  Index slots;
  Index* count;  // [exposed]
  Index* rows;   // [exposed][slots] of FoundEdge
  bool alone;    // see raise
};

/// A contact of a semi-edge as it is found: a row of 4.
struct FoundEdge {
  static constexpr Index numbers = 4;
  Index mother, target;  // 4 * exposed face + side
  Index before;          // place of this contact one step ago, or -1
  Index seen;            // 4 * pair of edges + mother side, see EdgePairs::held

  CDEM_HD static FoundEdge at(const Index* rows, std::size_t place) {
    const Index* r = rows + numbers * place;
    return {r[0], r[1], r[2], r[3]};
  }
  CDEM_HD void store(Index* rows, std::size_t place) const {
    Index* r = rows + numbers * place;
    r[0] = mother, r[1] = target, r[2] = before, r[3] = seen;
  }
  /// In the order of the target faces, of the mother's sides and of the target's.
  CDEM_HD bool is_before(const FoundEdge& other) const {
    if (target / 4 != other.target / 4) return target < other.target;
    return mother != other.mother ? mother < other.mother : target < other.target;
  }
};

/// Find which semi-edges touch: judge all ways of two edges that may.
struct ResolveTargetEdges : TouchingEdges {
  const Index* exposed_face;
  EdgePairs pairs;
  Flag* lost;  // [exposed] 1: a loaded contact was lost because it penetrated too deep
  FoundEdges found;

  /// More contacts than this on one face stop the run.
  static constexpr Index most_slots = 64;

  CDEM_HD Range items(Index p) const { return {p, p + 1}; }
  CDEM_HD bool selects(Index, Index p) const { return pairs.open[p] != 0; }

  template <class I>
  CDEM_HD void operator()(const I& item) const {
    const auto edges = pairs.at(item.id);
    const Touching touching = judge(edges);
    for_lanes(item, [&](Index lane, Index, Index p) {
      for (unsigned ways = std::uint8_t(pairs.open[p]); ways; ways &= ways - 1) {
        const Index way = std::countr_zero(ways), side = EdgeWays::mother(way);
        const Index mother = pairs.sides.at(side, p), m = mother / 4;
        if (touching.too_deep[way] >> lane & 1) set(lost[m]);
        if (!(touching.touches[way] >> lane & 1)) continue;
        const FoundEdge contact{mother, pairs.sides.at(EdgeWays::target(way), p),
                                of_lane(edges.before[side], lane), 4 * p + side};
        const Index place = raise(found.count[m], found.alone);
        if (place < found.slots) contact.store(found.rows, std::size_t(m) * found.slots + place);
      }
    });
  }

  /// Do two sides (4 * exposed face + side) touch? `shared` tells which of their ends began at the
  /// same place in the mesh, see SidePair; `before` is the place of their contact one step ago, or
  /// -1.
  CDEM_HD bool touch(Index mother, Index target, Index shared, Index before) const {
    const auto end = [&](Index side, Index which) {
      const ExposedRow& row = geometry.table[side / 4];
      return which ? row.end(side % 4) : row.corner[side % 4];
    };
    return judge(TwoEdges<Index>{
                     .end = {{end(mother, 0), end(mother, 1)}, {end(target, 0), end(target, 1)}},
                     .side = {{mother, mother}, {target, target}},
                     .code = EdgeWays::code_of(1, shared, 0, 0),
                     .before = {before, -1, -1, -1}})
        .touches[0];
  }

  CDEM_HD Index edge_of(Index side) const {
    return faces.face_edges[4 * exposed_face[side / 4] + side % 4];
  }
};

/// List the contacts found for one exposed face, in order: they go on or begin. Energy that the
/// springs of ended contacts did not give back is lost to friction and dashpot.
struct ListEdgeContacts {
  ResolveTargetEdges touch;
  FaceInterfaces interfaces;
  const Index* first;  // [exposed + 1] of the list
  Index* contact;      // rows of EdgeContact
  Real* friction;      // [exposed] lost so far  [J]
  Real* dashpot;       // [exposed] lost so far  [J]

  CDEM_HD void operator()(One m) const {
    const EdgesBefore& held = touch.held;
    const FoundEdges& found = touch.found;
    Index* row = found.rows + FoundEdge::numbers * std::size_t(m.i) * found.slots;
    sort(row, found.count[m.i]);
    for (Index j = 0; j < found.count[m.i]; ++j) {
      const FoundEdge edge = FoundEdge::at(row, j);
      EdgeContact{.mother = edge.mother,
                  .face = edge.target / 4,
                  .edge = touch.edge_of(edge.target),
                  .before = edge.before}
          .store(contact, first[m.i] + j);
      touch.pairs.held_at(edge.seen % 4, edge.seen / 4) = first[m.i] + j;
    }
    for (Index c = held.first[m.i]; c < held.first[m.i + 1]; ++c) {
      bool goes_on = false;
      for (Index j = 0; j < found.count[m.i]; ++j)
        goes_on = goes_on || FoundEdge::at(row, j).before == c;
      if (goes_on) continue;
      const DissipatedAtEnd lost = lost_at_end(c);
      friction[m.i] += lost.friction;
      dashpot[m.i] += lost.dashpot;
    }
  }

 private:
  CDEM_HD static void sort(Index* row, Index count) {
    for (Index j = 1; j < count; ++j) {
      const FoundEdge edge = FoundEdge::at(row, j);
      Index place = j;
      for (; place > 0 && edge.is_before(FoundEdge::at(row, place - 1)); --place)
        FoundEdge::at(row, place - 1).store(row, place);
      edge.store(row, place);
    }
  }
  CDEM_HD DissipatedAtEnd lost_at_end(Index c) const {
    const FaceColumns& faces = touch.faces;
    const FaceGeometry& geometry = touch.geometry;
    const EdgeContact contact = EdgeContact::at(touch.held.contact, c);
    const Index m = contact.mother / 4, k = contact.mother % 4;
    const Vec3<Real> out = geometry.normal(contact.face) - geometry.normal(m);
    const Index* target = faces.edge_nodes + 2 * contact.edge;
    const Side mother = side(geometry.table[m].corner[k], geometry.table[m].end(k)),
               crossed = side(target[0], target[1]);
    const Vec3<Real> n = edge_normal(mother.along, crossed.along, out);
    const Crossing<Real> at = cross_edges(mother.x, mother.along, crossed.x, crossed.along, n);
    const Real returned =
        interfaces.returned_n(interfaces.between(geometry.table, m, contact.face));
    return {ContactState::at(touch.held.state, c), returned, edge_frame(n, crossed.along),
            mother.way(at.s) - crossed.way(at.t)};
  }
  /// An edge one step ago, and how its ends have moved since.
  struct Side {
    Vec3<Real> x, along, way0, way1;
    CDEM_HD Vec3<Real> way(Real s) const { return way0 + s * (way1 - way0); }
  };
  CDEM_HD Side side(Index a, Index b) const {
    const FaceColumns& faces = touch.faces;
    const Vec3<Real> x = faces.position_before(a);
    return {.x = x,
            .along = faces.position_before(b) - x,
            .way0 = faces.dt * faces.nodes.velocity(a),
            .way1 = faces.dt * faces.nodes.velocity(b)};
  }
};

}  // namespace cdem
