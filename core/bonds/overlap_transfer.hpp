// overlap_transfer.hpp - kernels for contacts that follow the bonds of faces that overlap.
#pragma once

#include "core/bonds/bonded_pairs.hpp"
#include "core/bonds/handed_over.hpp"
#include "core/bonds/pair_sides.hpp"
#include "core/contact/force/contact_laws.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/narrow_phase/edge_ways.hpp"

namespace cdem {

/// A contact without force that the search keeps where it finds it, up to the highest gap.
CDEM_HD inline ContactState awaited_state(const SearchRules& rules) {
  ContactState state = ContactState::none();
  state.stress_free_gap = 0.5 * rules.lifted;
  return state;
}
CDEM_HD inline bool is_awaited(const ContactState& state) {
  return state.penetration < 0 && state.stress_free_gap > 0;
}

/// Force of the bonds of an overlap on its second face one step ago, along the mean normal of both
/// faces, compression > 0, and across  [N].
struct Carried {
  Real normal;
  Vec3<Real> shear;

  CDEM_HD static Carried of(const OverlapBonds& bonds, Index pair) {
    const Index* const face = bonds.pair_faces + 2 * std::size_t(pair);
    const Vec3<Real> n = unit(bonds.faces.shape_before(face[0]).normal() -
                              bonds.faces.shape_before(face[1]).normal());
    Vec3<Real> on_b{0, 0, 0};
    for (std::size_t k = 4; k < 8; ++k)
      on_b = on_b + Row::at(bonds.corner_force.rows + (8 * std::size_t(pair) + k) * 4).vector();
    const Real normal = dot(on_b, n);
    return {normal, on_b - normal * n};
  }
};

/// Is a spring of an overlap that was pressed free of stress at a gap?
CDEM_HD inline bool is_lifted(const OverlapBonds& bonds, Index pair) {
  bool lifted = false;
  for (Index c = bonds.point_first[pair]; c < bonds.point_first[pair + 1]; ++c)
    lifted = lifted || bonds.pairs.lift(One{c}, 0) > 0;
  return lifted && Carried::of(bonds, pair).normal > 0;
}
/// List those of released ones.
struct ListLifted {
  const Index* released;
  OverlapBonds bonds;

  template <class Act>
  CDEM_HD void visit(One item, const Act& act) const {
    if (is_lifted(bonds, released[item.i])) act(released[item.i]);
  }
};

/// Let the vertices of an exposed face that lie over the other faces of its lifted pairs await a
/// contact there; item: exposed face.
struct AwaitSprings {
  PairSides sides;
  const Index *first, *rows;  // sides by exposed face
  FaceColumns faces;
  SearchRules rules;
  Index *target, *target_before;
  Real* states;  // rows of ContactState

  CDEM_HD void operator()(One x) const {
    for (Index r = first[x.i]; r < first[x.i + 1]; ++r) {
      const Index mother = sides.face(rows[r]), other = sides.other(rows[r]);
      for (Index k = 0; k < faces.vertex_count(mother); ++k) {
        const Index slot = 4 * x.i + k;
        if (target[slot] >= 0 || !is_over(rules, faces, mother, k, other)) continue;
        target[slot] = target_before[slot] = sides.other_exposed(rows[r]);
        awaited_state(rules).store(states, slot);
      }
    }
  }
};

/// List the sides of faces of lifted pairs that cross sides of the other face; row: side.
struct ListAwaitedEdges {
  PairSides sides;
  FaceColumns faces;

  template <class Act>
  CDEM_HD void visit(One side, const Act& act) const {
    const Index target = sides.other(side.i);
    const FaceShape<Real> from = faces.shape(sides.face(side.i)), to = faces.shape(target);
    for (Index k = 0; k < from.count(); ++k)
      for (Index j = 0; j < to.count(); ++j)
        if (do_cross(from, k, to, j))
          act(EdgeContact{.mother = 4 * sides.exposed(side.i) + k,
                          .face = sides.other_exposed(side.i),
                          .edge = faces.face_edges[4 * target + j],
                          .before = -1});
  }

 private:
  CDEM_HD static Vec3<Real> along(const FaceShape<Real>& f, Index k) {
    return f.x[k + 1 == f.count() ? 0 : k + 1] - f.x[k];
  }
  CDEM_HD static bool do_cross(const FaceShape<Real>& from, Index k, const FaceShape<Real>& to,
                               Index j) {
    const Vec3<Real> a = along(from, k), b = along(to, j), c = cross(a, b);
    const Real least = parallel_edges * parallel_edges;
    if (!(dot(c, c) > least * dot(a, a) * dot(b, b))) return false;
    const Crossing<Real> at = cross_edges(from.x[k], a, to.x[j], b, unit(c));
    return !(at.s < 0 || at.s > 1 || at.t < 0 || at.t > 1);
  }
};

/// A contact that begins between the faces of a released overlap, as it was one step ago.
struct Successor {
  Index place;         // spring: slot; semi-edge: place in the list
  bool is_edge, on_b;  // does the force act on the second face?
  Frame<Real> frame;   // of its target
  Real depth, kn, ks;  // [m], [N/m]
  Real returned_n, returned_s;
  Index interface;
  JointStiffness<Real> k;  // [Pa/m]
};

/// The contacts that follow released overlaps, as the search has found them.
struct Successors {
  OverlapBonds bonds;
  SearchRules rules;
  FaceGeometry geometry;
  ContactLaws laws;
  const Index* exposed_face;
  Index *target, *target_before;
  Real* springs;  // rows of ContactState
  const Index* edge_first;
  Index* edges;       // rows of EdgeContact
  Real* edge_states;  // rows of ContactState, by EdgeContact::before

  /// Call act(contact) for those of a pair.
  template <class Act>
  CDEM_HD void each(Index pair, const Act& act) const {
    const Index* const face = bonds.pair_faces + 2 * std::size_t(pair);
    const Index x = bonds.faces.face_exposed[face[0]], y = bonds.faces.face_exposed[face[1]];
    each_of(x, y, false, act);
    each_of(y, x, true, act);
  }

 private:
  /// Contacts of exposed face x with y that begin now.
  template <class Act>
  CDEM_HD void each_of(Index x, Index y, bool on_b, const Act& act) const {
    const Index interface = laws.between(geometry, x, y);
    const ContactSpring<Real> spring = laws.spring(geometry, interface, x, y);
    const Successor like{.place = -1,
                         .is_edge = false,
                         .on_b = on_b,
                         .frame = bonds.faces.shape_before(exposed_face[y]).frame(),
                         .depth = 0,
                         .kn = spring.n(),
                         .ks = spring.s(),
                         .returned_n = laws.faces.returned_n(interface),
                         .returned_s = laws.faces.returned_s(interface),
                         .interface = interface,
                         .k = spring.stiffness};
    each_spring(x, y, like, act);
    each_edge(x, y, like, act);
  }
  template <class Act>
  CDEM_HD void each_spring(Index x, Index y, Successor spring, const Act& act) const {
    const FaceShape<Real> mother = bonds.faces.shape_before(exposed_face[x]),
                          other = bonds.faces.shape_before(exposed_face[y]);
    spring.kn *= 0.5, spring.ks *= 0.5;
    for (Index k = 0; k < mother.count(); ++k) {
      spring.place = 4 * x + k;
      const bool awaited = is_awaited(ContactState::at(springs, spring.place));
      if (target[spring.place] != y || (target_before[spring.place] >= 0 && !awaited)) continue;
      const Vec3<Real> acting = mother.x[k] + rules.action * (mother.center() - mother.x[k]);
      spring.depth = -project(other, acting, spring.frame.n).gap;
      if (spring.depth > 0 || awaited) act(spring);
    }
  }
  template <class Act>
  CDEM_HD void each_edge(Index x, Index y, Successor edge, const Act& act) const {
    const FaceColumns& faces = bonds.faces;
    const FaceShape<Real> mother = faces.shape_before(exposed_face[x]);
    const Vec3<Real> normal = edge.frame.n - mother.normal();
    edge.is_edge = true;
    for (edge.place = edge_first[x]; edge.place < edge_first[x + 1]; ++edge.place) {
      const EdgeContact contact = EdgeContact::at(edges, edge.place);
      const bool awaited =
          contact.before >= 0 && is_awaited(ContactState::at(edge_states, contact.before));
      if (contact.face != y || (contact.before >= 0 && !awaited)) continue;
      const Index k = contact.mother % 4, next = k + 1 == mother.count() ? 0 : k + 1;
      const Vec3<Real> along_m = mother.x[next] - mother.x[k];
      const Vec3<Real> start = faces.position_before(faces.edge_nodes[2 * contact.edge]);
      const Vec3<Real> along_t =
          faces.position_before(faces.edge_nodes[2 * contact.edge + 1]) - start;
      edge.frame = edge_frame(edge_normal(along_m, along_t, normal), along_t);
      edge.depth = -cross_edges(mother.x[k], along_m, start, along_t, edge.frame.n).gap;
      if (edge.depth > 0 || awaited) act(edge);
    }
  }
};

/// Count the rows that semi-edges among the contacts of a released pair need, as they had no state
/// one step ago.
struct CountNewStates {
  const Index* released;
  Successors contacts;
  Index* count;

  CDEM_HD void operator()(One item) const {
    const Index pair = released[item.i];
    Index rows = 0;
    if (Carried::of(contacts.bonds, pair).normal > 0)
      contacts.each(pair, [&](const Successor& c) {
        if (c.is_edge && EdgeContact::at(contacts.edges, c.place).before < 0) ++rows;
      });
    count[item.i] = rows;
  }
};

/// Share the force of a released pair by the depths of its contacts, and end its bonds; see
/// transfer_released_bonds.
struct GiveToSuccessors {
  const Index* released;
  Successors contacts;
  BondEnds ends;
  const Index* first;  // [item] of its new rows
  Index known;         // rows before

  CDEM_HD void operator()(One item) const {
    const One pair{released[item.i]};
    const OverlapBonds& bonds = contacts.bonds;
    const Carried carried = Carried::of(bonds, pair.i);
    if (carried.normal > 0) {
      Real pressed = 0, stiffness = 0;
      contacts.each(pair.i, [&](const Successor& c) {
        pressed += c.kn * max_of(c.depth, 0.0);
        stiffness += c.kn;
      });
      const Real part = pressed > 0 ? min_of(1.0, carried.normal / pressed) : 0;
      const Real lift =
          is_lifted(bonds, pair.i) ? (carried.normal - part * pressed) / stiffness : 0;
      Real stored = bonds.pairs.stored.at(0, pair);
      Index row = known + first[item.i];
      contacts.each(pair.i, [&](const Successor& c) {
        const Real penetration = part * max_of(c.depth, 0.0) + lift;
        const Real share = c.kn * penetration / carried.normal;
        stored -= give(c, penetration, (c.on_b ? share : -share) * carried.shear, row);
      });
      bonds.pairs.stored.set(0, pair, stored);
    }
    ends.end(pair);
  }

 private:
  /// Returns the energy that the contact holds  [J].
  CDEM_HD Real give(const Successor& c, Real penetration, const Vec3<Real>& shear,
                    Index& row) const {
    ContactState state{};
    state.penetration = penetration;
    state.approach = state.penetration;
    state.stress_free_gap = state.penetration - c.depth;
    state.force_n = c.kn * state.penetration;
    state.shear1 = dot(shear, c.frame.t1);
    state.shear2 = dot(shear, c.frame.t2);
    state.energy_n = c.returned_n * 0.5 * state.force_n * state.penetration;
    press(contacts.laws.interfaces, c.interface, c.kn / c.k.n, c.k, state);
    state.energy_s =
        c.returned_s * 0.5 / c.ks * (state.shear1 * state.shear1 + state.shear2 * state.shear2);
    if (c.is_edge) {
      EdgeContact contact = EdgeContact::at(contacts.edges, c.place);
      if (contact.before < 0) {
        contact.before = row++;
        contact.store(contacts.edges, c.place);
      }
      state.store(contacts.edge_states, contact.before);
    } else {
      contacts.target_before[c.place] = contacts.target[c.place];
      state.store(contacts.springs, c.place);
    }
    return state.energy_n + state.energy_s;
  }
};

}  // namespace cdem
