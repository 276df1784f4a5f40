// transfer_to_contact.cpp - see transfer_to_contact.hpp.
#include "core/bonds/transfer_to_contact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/bonds/views.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/edge_contacts.hpp"
#include "core/contact/narrow_phase/edge_pair.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

Real pair_length(const Model& m, const PairSet& p, Index i) {
  const auto length = on_host(m.face_length);
  const auto faces = on_host(p.faces);
  return std::min(length[faces[2 * i]], length[faces[2 * i + 1]]);
}

namespace {

/// A bond point of a conforming pair that is released while it is pressed, on half of its area:
/// the other half is for the face across.
struct ReleasedPoint {
  Index node[2];           // of either face
  Vec3<Real> apart;        // of those, one step ago  [m]
  Real depth, kn, ks;      // of its spring  [m], [N/m]
  Vec3<Real> strain;       // of its shear spring  [m]
  bool lifted;             // its spring is free of stress at a gap
  Index vertex[2];         // of either face, if that goes on as a contact, else -1
  Real share[2] = {1, 1};  // of the force of the point, in halves
};

/// The vertex of a face at a node, or -1.
Index vertex_at(const FaceColumns& faces, Index face, Index node) {
  for (Index v = 0; v < faces.vertex_count(face); ++v)
    if (faces.vertex(face, v) == node) return v;
  return -1;
}

/// Is the indented point of a vertex of face `mother` beside face `target`?
bool is_over(const SearchRules& rules, const FaceColumns& faces, Index mother, Index vertex,
             Index target) {
  const FaceShape<Real> from = faces.shape(mother), to = faces.shape(target);
  const Vec3<Real> v = from.x[vertex], p = v + rules.indentation * (from.center() - v);
  const Real length = std::min(faces.face_length[mother], faces.face_length[target]);
  return to.inside(p, to.normal(), rules.tolerance * length);
}

/// Let a contact on this area, which has its force, have the depth and energy of its law.
void press(const InterfaceTable& table, Index interface, Real area, const JointStiffness<Real>& k,
           ContactState& contact) {
  if (!table.closes_by_curve(interface)) return;
  const Real gap = contact.stress_free_gap - contact.approach;
  contact.approach = depth_under(table, interface, contact.force_n / area, k);
  contact.stress_free_gap = gap + contact.approach;
  contact.energy_n =
      area * joint_laws<InterfaceLaws>(table, interface).close(contact.approach, k).stored;
}

/// Vertices of a pair one step ago.
std::vector<ReleasedPoint> released_points(const Model& m, State& s, const PairSet& p,
                                           PairState& ps, Index i) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const PairColumns pairs = on_host(pair_columns(m, p, ps));
  const auto pair_faces = on_host(p.faces), nodes = on_host(p.nodes);
  const auto slip1 = on_host(ps.slip1), slip2 = on_host(ps.slip2);
  const Index face[2] = {pair_faces[2 * i], pair_faces[2 * i + 1]};
  const Index interface = on_host(p.interface)[i];
  const Frame<Real> frame = faces.shape_before(face[0]).frame();
  const Real area = 0.5 * on_host(p.area)[i] / p.points;
  const JointStiffness<Real> of_pair = pairs.spring(One{i}, area).stiffness;
  std::vector<ReleasedPoint> found;
  for (Index k = 0; k < p.points; ++k) {
    ReleasedPoint point{};
    for (Index side : {0, 1})
      point.node[side] = nodes[std::size_t(side * p.points + k) * p.stride + i];
    point.apart = faces.position_before(point.node[1]) - faces.position_before(point.node[0]);
    const Vec3<Real> jump = pairs.past_rest(One{i}, k, p.points, frame, point.apart);
    if (dot(frame.n, jump) >= 0) continue;  // open: nothing to carry over
    if (norm(point.apart) > 2 * m.rules.indentation * pair_length(m, p, i)) continue;
    const std::size_t row = std::size_t(k) * p.point_stride + i;
    const Vec3<Real> slip = slip1[row] * frame.t1 + slip2[row] * frame.t2;
    const Vec3<Real> along = jump - dot(frame.n, jump) * frame.n;
    point.depth = -dot(frame.n, jump);
    if (pairs.interfaces.closes_by_curve(interface)) {  // of a straight spring with its force
      const auto laws = joint_laws<InterfaceLaws>(pairs.interfaces, interface);
      point.depth = laws.close(point.depth, of_pair).pressure / of_pair.n;
    }
    point.kn = area * of_pair.n;
    point.ks = area * of_pair.s;
    point.strain = along - slip;
    point.lifted = pairs.lift(One{i}, k) > 0;
    for (Index side : {0, 1}) {
      const Index v = vertex_at(faces, face[side], point.node[side]);
      const bool stays = !point.lifted || is_over(m.rules, faces, face[side], v, face[1 - side]);
      point.vertex[side] = stays ? v : -1;
    }
    found.push_back(point);
  }
  return found;
}

/// Of a lifted point, what a vertex leaves that has slid off its face goes to the other one; where
/// both have, to the other points.
void share_out(std::vector<ReleasedPoint>& points) {
  Real all = 0, borne = 0;
  for (ReleasedPoint& point : points) {
    const Index staying = (point.vertex[0] >= 0) + (point.vertex[1] >= 0);
    for (Real& share : point.share) share = staying == 1 ? 2 : 1;
    all += point.kn * point.depth;
    if (staying > 0) borne += point.kn * point.depth;
  }
  if (!(borne > 0) || borne == all) return;
  for (ReleasedPoint& point : points)
    for (Real& share : point.share) share *= all / borne;
}

}  // namespace

Real transfer_to_contact(const Model& m, State& s, const PairSet& p, PairState& ps, Index i) {
  std::vector<ReleasedPoint> points = released_points(m, s, p, ps, i);
  share_out(points);
  const FaceColumns faces = on_host(face_columns(m, s));
  const InterfaceTable table = on_host(interface_table(m));
  const Index interface = on_host(p.interface)[i];
  const auto target = on_host(s.springs.target), target_before = on_host(s.springs.target_before);
  const auto springs = on_host(s.springs.state);
  const auto face_stiffness = on_host(m.face_stiffness);
  const Index face[2] = {on_host(p.faces)[2 * i], on_host(p.faces)[2 * i + 1]};
  const Index place[2] = {faces.face_exposed[face[0]], faces.face_exposed[face[1]]};
  const Frame<Real> frame[2] = {faces.shape_before(face[0]).frame(),
                                faces.shape_before(face[1]).frame()};
  const Interface& contact = table.interfaces[interface];
  const Real side_a = face_stiffness[face[0]], side_b = face_stiffness[face[1]];
  const Real area = 0.5 * on_host(p.area)[i] / p.points;
  const auto k = JointStiffness<Real>::of(contact.stiffness_n(side_a, side_b),
                                          contact.stiffness_s(side_a, side_b));
  const Real kn = area * k.n, ks = area * k.s;
  Real handed = 0;
  for (const ReleasedPoint& point : points)
    for (Index side : {0, 1}) {
      if (point.vertex[side] < 0) continue;
      // of the force: no deeper than the faces are, but lifted ones need not be deep
      const Real part = point.share[side] * (point.lifted ? 1 : std::min(1.0, kn / point.kn));
      const Real deeper =
          point.share[side] * (point.lifted ? point.kn / kn : std::min(1.0, point.kn / kn));
      const Vec3<Real> force = (side == 0 ? part : -part) * point.ks * point.strain;
      const Index slot = 4 * place[side] + point.vertex[side];
      target[slot] = target_before[slot] = place[1 - side];
      ContactState spring = ContactState::at(springs.data(), slot);
      spring.shear1 = dot(force, frame[1 - side].t1);
      spring.shear2 = dot(force, frame[1 - side].t2);
      spring.penetration = deeper * point.depth;
      spring.stress_free_gap = spring.penetration + dot(frame[0].n, point.apart);
      spring.approach = spring.penetration;
      spring.force_n = kn * spring.penetration;
      spring.energy_n = contact.returned_n * 0.5 * kn * spring.penetration * spring.penetration;
      press(table, interface, area, k, spring);
      spring.energy_s = contact.returned_s * 0.5 / ks *
                        (spring.shear1 * spring.shear1 + spring.shear2 * spring.shear2);
      spring.store(springs.data(), slot);
      handed += spring.energy_n + spring.energy_s;
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
    const auto first = on_host(p.point_first);
    const auto weights = on_host(side == 0 ? p.weights_a : p.weights_b);
    const auto area = on_host(p.point_area);
    for (Index c = first[i]; c < first[i + 1]; ++c)
      visit(std::size_t(c), area[c] * std::abs(weights[4 * c + vertex]));
    return;
  }
  const auto nodes = on_host(p.nodes);
  const Index node = on_host(m.face_nodes)[4 * on_host(p.faces)[2 * i + side] + vertex];
  for (Index k = 0; k < p.points; ++k)
    if (nodes[std::size_t(side * p.points + k) * p.stride + i] == node)
      visit(std::size_t(k) * p.point_stride + i, Real(1));
}

}  // namespace

void give_history(const Model& m, State& s, const PairSet& p, const PairState& ps, Index i) {
  const Index width = s.springs.history.width;
  if (width == 0) return;
  const HistoryRows vertices = on_host(history_rows(s.springs.history)),
                    sides = on_host(history_rows(s.edges.side_history));
  const FaceColumns faces = on_host(face_columns(m, s));
  const auto remembered = on_host(ps.history);
  const Index law = on_host(m.interfaces)[on_host(p.interface)[i]].law;
  const auto row = [width](const HistoryRows& h, Index place) {
    return h.rows + std::size_t(place) * width;
  };
  for (Index side = 0; side < 2; ++side) {
    const Index face = on_host(p.faces)[2 * i + side];
    const Index first = 4 * faces.face_exposed[face], count = faces.vertex_count(face);
    for (Index v = 0; v < count; ++v) {
      std::vector<Real> sum(width);
      Real total = 0;
      for_points_at(m, p, i, side, v, [&](std::size_t point, Real weight) {
        const std::size_t stride = std::size_t(p.points) * p.point_stride;
        for (Index k = 0; k < width; ++k) sum[k] += weight * remembered[k * stride + point];
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
  Index interface;
  JointStiffness<Real> k;  // [Pa/m]
};

/// A contact without force that the search keeps where it finds it, up to the highest gap.
ContactState awaited_state(const Model& m) {
  ContactState state = ContactState::none();
  state.stress_free_gap = 0.5 * m.rules.lifted;
  return state;
}
bool is_awaited(const ContactState& state) {
  return state.penetration < 0 && state.stress_free_gap > 0;
}

/// A contact of exposed face x with y, but for its place; its frame is that of y.
Successor successor(const Model& m, const State& s, Index x, Index y, bool on_b) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const FaceGeometry geometry = on_host(face_geometry(s));
  const ContactLaws laws = on_host(contact_laws(m, s));
  const Index interface = laws.between(geometry, x, y);
  const auto spring = laws.spring(geometry, interface, x, y);
  return {.place = -1,
          .is_edge = false,
          .on_b = on_b,
          .frame = faces.shape_before(on_host(s.search.exposed_face)[y]).frame(),
          .depth = 0,
          .kn = spring.n(),
          .ks = spring.s(),
          .returned_n = laws.faces.returned_n(interface),
          .returned_s = laws.faces.returned_s(interface),
          .interface = interface,
          .k = spring.stiffness};
}

/// Semi-springs of exposed face x on y that begin now, and are like this.
void add_springs(const Model& m, const State& s, Index x, Index y, Successor spring,
                 std::vector<Successor>& found) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const auto exposed_face = on_host(s.search.exposed_face);
  const auto targets = on_host(s.springs.target), targets_before = on_host(s.springs.target_before);
  const auto springs = on_host(s.springs.state);
  const FaceShape<Real> mother = faces.shape_before(exposed_face[x]),
                        target = faces.shape_before(exposed_face[y]);
  spring.kn *= 0.5, spring.ks *= 0.5;
  for (Index k = 0; k < mother.count(); ++k) {
    spring.place = 4 * x + k;
    const bool awaited = is_awaited(ContactState::at(springs.data(), spring.place));
    if (targets[spring.place] != y || (targets_before[spring.place] >= 0 && !awaited)) continue;
    const Vec3<Real> acting = mother.x[k] + m.rules.action * (mother.center() - mother.x[k]);
    spring.depth = -project(target, acting, spring.frame.n).gap;
    if (spring.depth > 0 || awaited) found.push_back(spring);
  }
}

/// The same of semi-edges.
void add_semi_edges(const Model& m, const State& s, Index x, Index y, Successor edge,
                    std::vector<Successor>& found) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const auto first = on_host(s.edges.first), contacts = on_host(s.edges.contact);
  const auto states_before = on_host(s.edges.old_state);
  const FaceShape<Real> mother = faces.shape_before(on_host(s.search.exposed_face)[x]);
  const Vec3<Real> normal = edge.frame.n - mother.normal();
  edge.is_edge = true;
  for (edge.place = first[x]; edge.place < first[x + 1]; ++edge.place) {
    const EdgeContact contact = EdgeContact::at(contacts.data(), edge.place);
    const bool awaited =
        contact.before >= 0 && is_awaited(ContactState::at(states_before.data(), contact.before));
    if (contact.face != y || (contact.before >= 0 && !awaited)) continue;
    const Index k = contact.mother % 4, next = k + 1 == mother.count() ? 0 : k + 1;
    const Vec3<Real> along_m = mother.x[next] - mother.x[k];
    const Vec3<Real> start = faces.position_before(faces.edge_nodes[2 * contact.edge]);
    const Vec3<Real> along_t =
        faces.position_before(faces.edge_nodes[2 * contact.edge + 1]) - start;
    edge.frame = edge_frame(edge_normal(along_m, along_t, normal), along_t);
    edge.depth = -cross_edges(mother.x[k], along_m, start, along_t, edge.frame.n).gap;
    if (edge.depth > 0 || awaited) found.push_back(edge);
  }
}

/// Contacts of exposed face x with y that begin now.
void add_successors(const Model& m, const State& s, Index x, Index y, bool on_b,
                    std::vector<Successor>& found) {
  const Successor like = successor(m, s, x, y, on_b);
  add_springs(m, s, x, y, like, found);
  add_semi_edges(m, s, x, y, like, found);
}

/// Returns the energy that the contact holds  [J].
Real give(const Model& m, State& s, const Successor& c, Real penetration, const Vec3<Real>& shear) {
  ContactState state{};
  state.penetration = penetration;
  state.approach = state.penetration;
  state.stress_free_gap = state.penetration - c.depth;
  state.force_n = c.kn * state.penetration;
  state.shear1 = dot(shear, c.frame.t1);
  state.shear2 = dot(shear, c.frame.t2);
  state.energy_n = c.returned_n * 0.5 * state.force_n * state.penetration;
  press(on_host(interface_table(m)), c.interface, c.kn / c.k.n, c.k, state);
  state.energy_s =
      c.returned_s * 0.5 / c.ks * (state.shear1 * state.shear1 + state.shear2 * state.shear2);
  if (c.is_edge) {
    const auto edges = on_host(s.edges.contact);
    EdgeContact contact = EdgeContact::at(edges.data(), c.place);
    if (contact.before < 0) {
      contact.before = Index(s.edges.old_state.size() / 8);
      contact.store(edges.data(), c.place);
      s.edges.old_state.resize(s.edges.old_state.size() + 8);
    }
    state.store(on_host(s.edges.old_state).data(), contact.before);
  } else {
    on_host(s.springs.target_before)[c.place] = on_host(s.springs.target)[c.place];
    state.store(on_host(s.springs.state).data(), c.place);
  }
  return state.energy_n + state.energy_s;
}

/// Force of the bonds of an overlap on its second face one step ago  [N].
Vec3<Real> force_on_second(const State& s, const PairSet& p, Index i) {
  const auto force = on_host(s.corner_force);
  Vec3<Real> sum{0, 0, 0};
  for (std::size_t k = 4; k < 8; ++k)
    sum = sum + Row::at(force.data() + (p.corner_first + 8 * std::size_t(i) + k) * 4).vector();
  return sum;
}

/// Force of the bonds of an overlap on its second face one step ago, along the mean normal of both
/// faces, compression > 0, and across  [N].
struct Carried {
  Real normal;
  Vec3<Real> shear;

  Carried(const Model& m, State& s, const PairSet& p, Index i) {
    const FaceColumns faces = on_host(face_columns(m, s));
    const auto pair_faces = on_host(p.faces);
    const Vec3<Real> n = unit(faces.shape_before(pair_faces[2 * i]).normal() -
                              faces.shape_before(pair_faces[2 * i + 1]).normal());
    const Vec3<Real> on_b = force_on_second(s, p, i);
    normal = dot(on_b, n);
    shear = on_b - normal * n;
  }
};

/// Is a spring of a released overlap that was pressed free of stress at a gap?
bool is_lifted(const Model& m, State& s, Index i) {
  const PairSet& p = m.overlaps;
  const PairColumns pairs = on_host(pair_columns(m, p, s.overlaps));
  const auto first = on_host(p.point_first);
  bool lifted = false;
  for (Index c = first[i]; c < first[i + 1]; ++c) lifted = lifted || pairs.lift(One{c}, 0) > 0;
  return lifted && Carried(m, s, p, i).normal > 0;
}

/// Vertices of exposed face x over y.
void await_springs(const Model& m, State& s, Index x, Index y) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const auto exposed_face = on_host(s.search.exposed_face);
  const auto targets = on_host(s.springs.target), targets_before = on_host(s.springs.target_before);
  const auto states = on_host(s.springs.state);
  const Index mother = exposed_face[x], target = exposed_face[y];
  for (Index k = 0; k < faces.vertex_count(mother); ++k) {
    const Index slot = 4 * x + k;
    if (targets[slot] >= 0 || !is_over(m.rules, faces, mother, k, target)) continue;
    targets[slot] = targets_before[slot] = y;
    awaited_state(m).store(states.data(), slot);
  }
}

/// Sides of exposed face x that cross sides of y.
void await_edges(const Model& m, State& s, Index x, Index y, std::vector<EdgeContact>& found) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const auto exposed_face = on_host(s.search.exposed_face);
  const Index mother = exposed_face[x], target = exposed_face[y];
  const FaceShape<Real> from = faces.shape(mother), to = faces.shape(target);
  const auto along = [](const FaceShape<Real>& f, Index k) {
    return f.x[k + 1 == f.count() ? 0 : k + 1] - f.x[k];
  };
  for (Index k = 0; k < from.count(); ++k)
    for (Index j = 0; j < to.count(); ++j) {
      const Vec3<Real> a = along(from, k), b = along(to, j), c = cross(a, b);
      if (!(dot(c, c) > parallel_edges * parallel_edges * dot(a, a) * dot(b, b))) continue;
      const Crossing<Real> at = cross_edges(from.x[k], a, to.x[j], b, unit(c));
      if (at.s < 0 || at.s > 1 || at.t < 0 || at.t > 1) continue;
      found.push_back(
          {.mother = 4 * x + k, .face = y, .edge = faces.face_edges[4 * target + j], .before = -1});
    }
}

}  // namespace

void await_contacts(const Model& m, State& s) {
  const auto faces = on_host(m.overlaps.faces);
  const auto place = on_host(s.search.face_exposed);
  std::vector<EdgeContact> edges;
  for (const Index i : on_host(s.released_overlaps)) {
    if (!is_lifted(m, s, i)) continue;
    const Index x = place[faces[2 * i]], y = place[faces[2 * i + 1]];
    await_springs(m, s, x, y);
    await_springs(m, s, y, x);
    if (!m.semi_edges) continue;
    await_edges(m, s, x, y, edges);
    await_edges(m, s, y, x, edges);
  }
  Column<Index> contacts;
  contacts.renew(4 * edges.size());
  const auto rows = on_host(contacts);
  for (std::size_t c = 0; c < edges.size(); ++c) edges[c].store(rows.data(), c);
  add_edges(s, contacts, awaited_state(m));
}

void transfer_released_bonds(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::search);
  if (s.released_overlaps.size() == 0) return;
  finish(q);
  const PairSet& p = m.overlaps;
  const auto faces = on_host(p.faces);
  const auto place = on_host(s.search.face_exposed);
  const auto stored = on_host(s.overlaps.stored), friction = on_host(s.overlaps.friction);
  for (const Index i : on_host(s.released_overlaps)) {
    const Index x = place[faces[2 * i]], y = place[faces[2 * i + 1]];
    std::vector<Successor> contacts;
    add_successors(m, s, x, y, false, contacts);
    add_successors(m, s, y, x, true, contacts);
    const Carried carried(m, s, p, i);
    Real pressed = 0, stiffness = 0;
    for (const Successor& c : contacts) pressed += c.kn * std::max(c.depth, 0.0), stiffness += c.kn;
    const Real part = pressed > 0 ? std::min(1.0, carried.normal / pressed) : 0;
    const Real lift = is_lifted(m, s, i) ? (carried.normal - part * pressed) / stiffness : 0;
    if (carried.normal > 0)
      for (const Successor& c : contacts) {
        const Real penetration = part * std::max(c.depth, 0.0) + lift;
        const Real share = c.kn * penetration / carried.normal;
        stored[i] -= give(m, s, c, penetration, (c.on_b ? share : -share) * carried.shear);
      }
    friction[i] += stored[i];
    stored[i] = 0;
    clear_corner_rows(s, p, i);
  }
  s.released_overlaps.resize(0);
}

}  // namespace cdem
