// target_edge.hpp - which edges a semi-edge crosses. Feng et al. (2014), Eq. 10-12.
#pragma once

#include "core/base/parallel.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/geometry/face_interfaces.hpp"
#include "core/contact/narrow_phase/closed_contact.hpp"
#include "core/contact/narrow_phase/edge_pair.hpp"
#include "core/contact/narrow_phase/flush_faces.hpp"
#include "core/contact/narrow_phase/touching_edges.hpp"

namespace cdem {

/// Find which semi-edges touch: judge all ways of two edges that may.
struct ResolveTargetEdges {
  TouchingEdges touching;
  EdgePairs pairs;
  Flag* lost;  // [exposed] 1: a loaded contact was lost because it penetrated too deep

  CDEM_HD Range items(Index p) const { return {p, p + 1}; }
  CDEM_HD bool selects(Index, Index p) const { return pairs.open[p] != 0; }

  template <class I>
  CDEM_HD void operator()(const I& item) const {
    const Touching found = touching.judge(pairs.at(item.id));
    for_lanes(item, [&](Index lane, Index, Index p) {
      Index touch = 0;
      EdgeWays::visit(pairs.open[p], [&](Index way) {
        touch |= (found.touches[way] >> lane & 1) << way;
        if (found.too_deep[way] >> lane & 1) set(lost[pairs.mother(p, way) / 4]);
      });
      pairs.open[p] = Flag(touch);
    });
  }
};

/// Drop contacts that would begin beyond a sharp rim, or in the seams of blocks that lie flush.
struct DropHiddenEdges {
  HiddenEdges hidden;
  EdgePairs pairs;

  CDEM_HD void operator()(One p) const {
    if (!pairs.open[p.i]) return;
    Index open = 0;
    EdgeWays::visit(pairs.open[p.i], [&](Index way) {
      const bool goes_on = pairs.held[pairs.place_held(EdgeWays::mother(way), p.i)] >= 0;
      if (goes_on || !hidden.hide(pairs.mother(p.i, way), pairs.target(p.i, way))) open |= 1 << way;
    });
    pairs.open[p.i] = Flag(open);
  }
};

/// The ways in which pairs of edges touch, by the mother's exposed face, see list_rows.
struct FoundEdges {
  EdgePairs pairs;

  template <class Do>
  CDEM_HD void visit(One p, const Do& act) const {
    EdgeWays::visit(pairs.open[p.i], [&](Index way) {
      act(pairs.mother(p.i, way) / 4, EdgeWays::count * p.i + way);
    });
  }
  /// In the order of the target faces, of the mother's sides and of the target's.
  CDEM_HD bool is_before(Index one, Index other) const {
    const Index p = one / EdgeWays::count, way = one % EdgeWays::count;
    const Index q = other / EdgeWays::count, other_way = other % EdgeWays::count;
    const Index target = pairs.target(p, way), other_target = pairs.target(q, other_way);
    if (target / 4 != other_target / 4) return target < other_target;
    const Index mother = pairs.mother(p, way), other_mother = pairs.mother(q, other_way);
    return mother != other_mother ? mother < other_mother : target < other_target;
  }
};

/// List the contacts found for one exposed face, in order: they go on or begin. Energy that the
/// springs of ended contacts did not give back is lost to friction and dashpot.
struct ListEdgeContacts {
  ResolveTargetEdges search;
  FaceInterfaces interfaces;
  const Index* first;  // [exposed + 1] of the list
  const Index* found;  // FoundEdges
  Index* contact;      // rows of EdgeContact
  Index* seen;         // where EdgePairs::held holds a contact
  Real* friction;      // [exposed] lost so far  [J]
  Real* dashpot;       // [exposed] lost so far  [J]

  CDEM_HD void operator()(One m) const {
    const EdgesBefore& held = search.touching.held;
    const Index from = first[m.i], to = first[m.i + 1];
    for (Index c = from; c < to; ++c) {
      const Index p = found[c] / EdgeWays::count, way = found[c] % EdgeWays::count;
      const Index target = search.pairs.target(p, way);
      seen[c] = search.pairs.place_held(EdgeWays::mother(way), p);
      EdgeContact{.mother = search.pairs.mother(p, way),
                  .face = target / 4,
                  .edge = search.pairs.edges.at(EdgeWays::target(way) / 2, p),
                  .before = search.pairs.held[seen[c]]}
          .store(contact, c);
    }
    for (Index old = held.first[m.i]; old < held.first[m.i + 1]; ++old) {
      bool goes_on = false;
      for (Index c = from; c < to; ++c)
        goes_on = goes_on || EdgeContact::at(contact, c).before == old;
      if (goes_on) continue;
      const DissipatedAtEnd lost = lost_at_end(old);
      friction[m.i] += lost.friction;
      dashpot[m.i] += lost.dashpot;
    }
  }

 private:
  CDEM_HD DissipatedAtEnd lost_at_end(Index c) const {
    const FaceColumns& faces = search.touching.faces;
    const FaceGeometry& geometry = search.touching.geometry;
    const EdgeContact contact = EdgeContact::at(search.touching.held.contact, c);
    const Index m = contact.mother / 4, k = contact.mother % 4;
    const Vec3<Real> out = geometry.normal(contact.face) - geometry.normal(m);
    const Index* target = faces.edge_nodes + 2 * contact.edge;
    const Side mother = side(geometry.table[m].corner[k], geometry.table[m].end(k)),
               crossed = side(target[0], target[1]);
    const Vec3<Real> n = edge_normal(mother.along, crossed.along, out);
    const Crossing<Real> at = cross_edges(mother.x, mother.along, crossed.x, crossed.along, n);
    const Real returned =
        interfaces.returned_n(interfaces.between(geometry.table, m, contact.face));
    return {ContactState::at(search.touching.held.state, c), returned, edge_frame(n, crossed.along),
            mother.way(at.s) - crossed.way(at.t)};
  }
  /// An edge one step ago, and how its ends have moved since.
  struct Side {
    Vec3<Real> x, along, way0, way1;
    CDEM_HD Vec3<Real> way(Real s) const { return way0 + s * (way1 - way0); }
  };
  CDEM_HD Side side(Index a, Index b) const {
    const FaceColumns& faces = search.touching.faces;
    const Vec3<Real> x = faces.position_before(a);
    return {.x = x,
            .along = faces.position_before(b) - x,
            .way0 = faces.dt * faces.nodes.velocity(a),
            .way1 = faces.dt * faces.nodes.velocity(b)};
  }
};

}  // namespace cdem
