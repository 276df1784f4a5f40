// transfer_to_contact.cpp - see transfer_to_contact.hpp.
#include "core/bonds/transfer_to_contact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/bonds/views.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

Real pair_length(const Model& m, const PairSet& p, Index i) {
  return std::min(m.face_length[p.faces[2 * i]], m.face_length[p.faces[2 * i + 1]]);
}

Real transfer_to_contact(const Model& m, State& s, const PairSet& p, PairState& ps, Index i) {
  const FaceColumns faces = face_columns(m, s);
  const PairColumns pairs = pair_columns(m, p, ps);
  const Index a = p.faces[2 * i], b = p.faces[2 * i + 1];
  const Index place_a = s.search.face_exposed[a], place_b = s.search.face_exposed[b];
  const Frame<Real> frame_a = faces.shape_before(a).frame(),
                    frame_b = faces.shape_before(b).frame();
  const Interface& contact = m.interfaces[p.interface[i]];
  const Real side_a = m.face_stiffness[a], side_b = m.face_stiffness[b];
  Real handed = 0;
  for (Index k = 0; k < p.points; ++k) {
    const Index node_a = p.nodes[std::size_t(k) * p.stride + i];
    const Index node_b = p.nodes[std::size_t(p.points + k) * p.stride + i];
    const Vec3<Real> apart = faces.position_before(node_b) - faces.position_before(node_a);
    const Vec3<Real> jump = pairs.past_rest(One{i}, k, p.points, frame_a, apart);
    if (dot(frame_a.n, jump) >= 0) continue;  // open: nothing to carry over
    if (norm(apart) > 2 * m.rules.indentation * pair_length(m, p, i)) continue;
    const std::size_t point = std::size_t(k) * p.point_stride + i;
    // half of it on either side
    const Real area = 0.5 * p.area[i] / p.points, bond_n = area * p.stiffness[i],
               bond_s = area * p.stiffness[std::size_t(p.stride) + i];
    const Real kn = area * contact.stiffness_n(side_a, side_b),
               ks = area * contact.stiffness_s(side_a, side_b);
    // of the force: no deeper than the faces are, but under initial stress they need not be deep
    const Real part = m.initial_stress ? 1 : std::min(1.0, kn / bond_n);
    const Vec3<Real> slip = ps.slip1[point] * frame_a.t1 + ps.slip2[point] * frame_a.t2;
    const Vec3<Real> along = jump - dot(frame_a.n, jump) * frame_a.n;
    const Vec3<Real> on_b = -part * bond_s * (along - slip);
    const auto give = [&](Index place, Index face, Index node, Index target,
                          const Frame<Real>& frame, const Vec3<Real>& force) {
      for (Index v = 0; v < faces.vertex_count(face); ++v) {
        if (faces.vertex(face, v) != node) continue;
        const Index slot = 4 * place + v;
        s.springs.target[slot] = s.springs.target_before[slot] = target;
        ContactState spring = ContactState::at(s.springs.state.data(), slot);
        spring.shear1 = dot(force, frame.t1);
        spring.shear2 = dot(force, frame.t2);
        const Real deeper = m.initial_stress ? bond_n / kn : std::min(1.0, bond_n / kn);
        spring.penetration = -deeper * dot(frame_a.n, jump);
        spring.stress_free_gap = spring.penetration + dot(frame_a.n, apart);
        spring.approach = spring.penetration;
        spring.force_n = kn * spring.penetration;
        spring.energy_n = contact.returned_n * 0.5 * kn * spring.penetration * spring.penetration;
        spring.energy_s = contact.returned_s * 0.5 / ks *
                          (spring.shear1 * spring.shear1 + spring.shear2 * spring.shear2);
        spring.store(s.springs.state.data(), slot);
        handed += spring.energy_n + spring.energy_s;
      }
    };
    give(place_a, a, node_a, place_b, frame_b, -on_b);
    give(place_b, b, node_b, place_a, frame_a, on_b);
  }
  return handed;
}

namespace {

/// Visit the bond points of a pair that bear on a vertex of one of its faces: place of the point in
/// the point tables, and its weight there.
template <class Visit>
void for_points_at(const Model& m, const PairSet& p, Index i, Index side, Index vertex,
                   Visit&& visit) {
  if (p.point_first.size() > 0) {
    const Column<Real>& weights = side == 0 ? p.weights_a : p.weights_b;
    for (Index c = p.point_first[i]; c < p.point_first[i + 1]; ++c)
      visit(std::size_t(c), p.point_area[c] * std::abs(weights[4 * c + vertex]));
    return;
  }
  const Index node = m.face_nodes[4 * p.faces[2 * i + side] + vertex];
  for (Index k = 0; k < p.points; ++k)
    if (p.nodes[std::size_t(side * p.points + k) * p.stride + i] == node)
      visit(std::size_t(k) * p.point_stride + i, Real(1));
}

}  // namespace

void give_history(const Model& m, State& s, const PairSet& p, const PairState& ps, Index i) {
  HistoryColumns &vertices = s.springs.history, &sides = s.edges.side_history;
  const Index width = vertices.width;
  if (width == 0) return;
  const Index law = m.interfaces[p.interface[i]].law;
  const auto row = [width](HistoryColumns& h, Index place) {
    return h.rows.data() + std::size_t(place) * width;
  };
  for (Index side = 0; side < 2; ++side) {
    const Index face = p.faces[2 * i + side];
    const Index first = 4 * s.search.face_exposed[face];
    const Index count = m.face_nodes[4 * face + 3] < 0 ? 3 : 4;
    for (Index v = 0; v < count; ++v) {
      std::vector<Real> sum(width);
      Real total = 0;
      for_points_at(m, p, i, side, v, [&](std::size_t point, Real weight) {
        const std::size_t stride = std::size_t(p.points) * p.point_stride;
        for (Index k = 0; k < width; ++k) sum[k] += weight * ps.history[k * stride + point];
        total += weight;
      });
      for (Index k = 0; k < width && total > 0; ++k) row(vertices, first + v)[k] = sum[k] / total;
      if (total > 0) vertices.law[first + v] = law;
    }
    for (Index v = 0; v < count; ++v) {
      const Index end = v + 1 == count ? 0 : v + 1;
      for (Index k = 0; k < width; ++k)
        row(sides, first + v)[k] =
            0.5 * (row(vertices, first + v)[k] + row(vertices, first + end)[k]);
      sides.law[first + v] = law;
    }
  }
}

namespace {

/// A contact that begins between the faces of a released overlap, as it was one step ago.
struct Successor {
  Index place;         // spring: slot; semi-edge: place in the list
  bool is_edge, on_b;  // does the force act on the second face?
  Frame<Real> frame;   // of its target
  Real depth, kn, ks;  // [m], [N/m]
  Real returned_n, returned_s;
};

/// Contacts of exposed face x with y that begin now.
void add_successors(const Model& m, const State& s, Index x, Index y, bool on_b,
                    std::vector<Successor>& found) {
  const FaceColumns faces = face_columns(m, s);
  const FaceGeometry geometry = face_geometry(s);
  const ContactLaws laws = contact_laws(m, s);
  const Index interface = laws.between(geometry, x, y);
  const auto spring = laws.spring(geometry, interface, x, y);
  const Real returned_n = laws.faces.returned_n(interface),
             returned_s = laws.faces.returned_s(interface);
  const FaceShape<Real> mother = faces.shape_before(s.search.exposed_face[x]),
                        target = faces.shape_before(s.search.exposed_face[y]);
  const Frame<Real> frame = target.frame();
  const auto add = [&](Successor c) {
    if (c.depth > 0 || m.initial_stress) found.push_back(c);
  };
  for (Index k = 0; k < mother.count(); ++k) {
    const Index slot = 4 * x + k;
    if (s.springs.target[slot] != y || s.springs.target_before[slot] >= 0) continue;
    const Vec3<Real> acting = mother.x[k] + m.rules.action * (mother.center() - mother.x[k]);
    add({.place = slot,
         .is_edge = false,
         .on_b = on_b,
         .frame = frame,
         .depth = -project(target, acting, frame.n).gap,
         .kn = 0.5 * spring.n(),
         .ks = 0.5 * spring.s(),
         .returned_n = returned_n,
         .returned_s = returned_s});
  }
  for (Index c = s.edges.first[x]; c < s.edges.first[x + 1]; ++c) {
    const EdgeContact contact = EdgeContact::at(s.edges.contact.data(), c);
    if (contact.face != y || contact.before >= 0) continue;
    const Index k = contact.mother % 4, next = k + 1 == mother.count() ? 0 : k + 1;
    const Vec3<Real> along_m = mother.x[next] - mother.x[k];
    const Vec3<Real> start = faces.position_before(faces.edge_nodes[2 * contact.edge]);
    const Vec3<Real> along_t =
        faces.position_before(faces.edge_nodes[2 * contact.edge + 1]) - start;
    const Frame<Real> at =
        edge_frame(edge_normal(along_m, along_t, frame.n - mother.normal()), along_t);
    add({.place = c,
         .is_edge = true,
         .on_b = on_b,
         .frame = at,
         .depth = -cross_edges(mother.x[k], along_m, start, along_t, at.n).gap,
         .kn = spring.n(),
         .ks = spring.s(),
         .returned_n = returned_n,
         .returned_s = returned_s});
  }
}

/// Returns the energy that the contact holds  [J].
Real give(State& s, const Successor& c, Real penetration, const Vec3<Real>& shear) {
  ContactState state{};
  state.penetration = penetration;
  state.approach = state.penetration;
  state.stress_free_gap = state.penetration - c.depth;
  state.force_n = c.kn * state.penetration;
  state.shear1 = dot(shear, c.frame.t1);
  state.shear2 = dot(shear, c.frame.t2);
  state.energy_n = c.returned_n * 0.5 * state.force_n * state.penetration;
  state.energy_s =
      c.returned_s * 0.5 / c.ks * (state.shear1 * state.shear1 + state.shear2 * state.shear2);
  if (c.is_edge) {
    EdgeContact contact = EdgeContact::at(s.edges.contact.data(), c.place);
    contact.before = Index(s.edges.old_state.size() / 8);
    contact.store(s.edges.contact.data(), c.place);
    s.edges.old_state.resize(s.edges.old_state.size() + 8);
    state.store(s.edges.old_state.data(), contact.before);
  } else {
    s.springs.target_before[c.place] = s.springs.target[c.place];
    state.store(s.springs.state.data(), c.place);
  }
  return state.energy_n + state.energy_s;
}

/// What the bonds of an overlap did to its second face one step ago  [N].
Vec3<Real> force_on_second(const State& s, const PairSet& p, Index i) {
  Vec3<Real> sum{0, 0, 0};
  for (std::size_t k = 4; k < 8; ++k)
    sum = sum +
          Row::at(s.corner_force.data() + (p.corner_first + 8 * std::size_t(i) + k) * 4).vector();
  return sum;
}

}  // namespace

void transfer_released_bonds(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::search);
  if (s.released_overlaps.size() == 0) return;
  finish(q);
  const PairSet& p = m.overlaps;
  for (std::size_t r = 0; r < s.released_overlaps.size(); ++r) {
    const Index i = s.released_overlaps[r];
    const Index a = p.faces[2 * i], b = p.faces[2 * i + 1];
    std::vector<Successor> contacts;
    add_successors(m, s, s.search.face_exposed[a], s.search.face_exposed[b], false, contacts);
    add_successors(m, s, s.search.face_exposed[b], s.search.face_exposed[a], true, contacts);
    const FaceColumns faces = face_columns(m, s);
    const Vec3<Real> n = unit(faces.shape_before(a).normal() - faces.shape_before(b).normal());
    const Vec3<Real> on_b = force_on_second(s, p, i);
    const Real carried = dot(on_b, n);
    const Vec3<Real> shear = on_b - carried * n;
    Real pressed = 0, stiffness = 0;
    for (const Successor& c : contacts) pressed += c.kn * c.depth, stiffness += c.kn;
    const Real part = std::min(1.0, carried / pressed);
    if (carried > 0)
      for (const Successor& c : contacts) {
        const Real penetration = m.initial_stress ? carried / stiffness : part * c.depth;
        const Real share = c.kn * penetration / carried;
        s.overlaps.stored[i] -= give(s, c, penetration, (c.on_b ? share : -share) * shear);
      }
    s.overlaps.friction[i] += s.overlaps.stored[i];
    s.overlaps.stored[i] = 0;
  }
  s.released_overlaps.resize(0);
}

}  // namespace cdem
