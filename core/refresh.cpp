// refresh.cpp - now and then: release broken pairs, expose faces, have the lists renewed.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/backend.hpp"
#include "core/candidates.hpp"
#include "core/check.hpp"
#include "core/close_lists.hpp"
#include "core/columns.hpp"
#include "core/contact/force.hpp"
#include "core/edge_list.hpp"
#include "core/hand_over.hpp"
#include "core/proximity.hpp"
#include "core/rest.hpp"
#include "core/surface.hpp"

namespace cdem {

namespace {

/// A pair whose points are all broken has its faces released once they have moved apart or along
/// each other by this part of the indentation; by the whole indentation, at once.
constexpr Real release_part = 0.1;

bool release_is_due(const Model& m, const PairSet& p, const PairState& s) {
  bool due = false;
#pragma omp parallel for schedule(static) reduction(|| : due) if (p.count >= worth_threads)
  for (Index i = 0; i < p.count; ++i)
    due = due || (s.jump[i] > 0 && s.jump[i] > m.rules.indentation * pair_length(m, p, i));
  return due;
}

/// Visit all state that belongs to exposed faces: column, numbers a face, what a new one begins
/// with.
template <class Visit>
void visit_faces(State& s, Visit&& visit) {
  SpringState& c = s.springs;
  visit(c.target, 4, Index(-1));
  visit(c.target_before, 4, Index(-1));
  for (Column<Real>* column : {&c.friction, &c.dashpot}) visit(*column, 4, Real(0));
  for (Column<Real>* column : {&c.state, &c.reaction}) visit(*column, 4 * 8, Real(0));
  visit(c.lost, 4, Flag(0));
  visit(s.edges.friction, 1, Real(0));
  visit(s.edges.dashpot, 1, Real(0));
  visit(s.edges.lost, 1, Flag(0));
  visit(s.face_geometry, 8, Real(0));
  visit(s.contact_force, 4 * 4, Real(0));
}

void expose(State& s, Index face) {
  if (s.search.face_exposed[face] >= 0) return;
  s.search.face_exposed[face] = Index(s.search.exposed_face.size());
  s.search.exposed_face.push(face);
  const std::size_t count = s.search.exposed_face.size();
  visit_faces(s, [&](auto& column, Index row, auto fill) { column.resize(row * count, fill); });
  s.edges.first.resize(count + 1, Index(s.edges.contact.size() / 4));
}

/// Put exposed faces into the order of the model, in which faces that are near each other mostly
/// lie together, also in memory.
void sort_exposed(State& s) {
  Column<Index>&exposed = s.search.exposed_face, &place = s.search.face_exposed;
  const std::size_t count = exposed.size();
  if (std::is_sorted(exposed.data(), exposed.data() + count)) return;
  std::vector<Index> from(count), to(count);  // places
  std::iota(from.begin(), from.end(), 0);
  std::sort(from.begin(), from.end(), [&](Index a, Index b) { return exposed[a] < exposed[b]; });
  for (std::size_t x = 0; x < count; ++x) to[from[x]] = Index(x);
  const auto follow = [&](Column<Index>& targets) {
    for (std::size_t k = 0; k < targets.size(); ++k)
      if (targets[k] >= 0) targets[k] = to[targets[k]];
  };
  follow(s.springs.target);
  follow(s.springs.target_before);
  sort_edges(s, from, to);
  const auto sort_rows = [&](auto& column, std::size_t row, auto) {
    const auto before = std::vector(column.data(), column.data() + row * count);
    for (std::size_t x = 0; x < count; ++x)
      std::copy_n(before.data() + row * from[x], row, column.data() + row * x);
  };
  visit_faces(s, sort_rows);
  sort_rows(exposed, 1, Index(-1));
  for (std::size_t x = 0; x < count; ++x) place[exposed[x]] = Index(x);
}

/// A pair that holds by some of its points and is this part of its length apart at another is a
/// hinge: what comes between its faces touches them.
constexpr Real hinge_part = 0.05;

/// Expose the faces of conforming pairs that have opened as hinges. Their broken points carry
/// nothing any more; what little those held is lost to friction.
template <Index count>
void open_hinges(const Model& m, State& s, const PairSet& p, PairState& ps, Real indentation) {
  const ConformingBonds<count> bonds{{s.nodes.motion.data()},
                                     {p.nodes.data(), p.stride},
                                     pair_columns(m, p, ps),
                                     indentation,
                                     0,
                                     false,
                                     {}};
  for (Index i = 0; i < p.count; ++i) {
    const auto point = [&](Index k) { return std::size_t(k) * p.point_stride + i; };
    const auto holds = [&](Index k) { return ps.bond[point(k)] > 0; };
    Index holding = 0;
    for (Index k = 0; k < count; ++k) holding += holds(k);
    if (ps.live[i] != 1 || holding == 0 || holding == count) continue;
    Vec3<Real> mean[count], jump[count];
    bonds.gather_jumps(One{i}, mean, jump);
    Real widest = 0;
    for (Index k = 0; k < count; ++k)
      if (!holds(k)) widest = std::max(widest, norm(jump[k]));
    if (!(widest > hinge_part * pair_length(m, p, i))) continue;
    const Frame<Real> frame = pair_frame<count>(mean);
    const BondLaw<Real> law = bonds.law_of(One{i});
    for (Index k = 0; k < count; ++k) {
      const Real opening = dot(frame.n, jump[k]);
      if (holds(k) || opening >= 0) continue;
      const Real held =
          stored_energy(law, law.stiffness_n * opening,
                        law.stiffness_s * (dot(frame.t1, jump[k]) - ps.slip1[point(k)]),
                        law.stiffness_s * (dot(frame.t2, jump[k]) - ps.slip2[point(k)]));
      ps.friction[i] += held;
      ps.stored[i] -= held;
    }
    ps.live[i] = 2;
    expose(s, p.faces[2 * i]);
    expose(s, p.faces[2 * i + 1]);
  }
}

/// Returns whether any was released.
bool release_pairs(const Model& m, State& s, const PairSet& p, PairState& ps) {
  bool any = false;
  for (Index i = 0; i < p.count; ++i) {
    if (!(ps.live[i] > 0)) continue;
    if (!(ps.jump[i] > release_part * m.rules.indentation * pair_length(m, p, i))) continue;
    expose(s, p.faces[2 * i]);
    expose(s, p.faces[2 * i + 1]);
    if (p.point_first.size() > 0) {
      s.released_overlaps.push(i);
    } else {
      if (ps.live[i] == 1) ps.stored[i] -= hand_over(m, s, p, ps, i);
      ps.friction[i] += ps.stored[i];
      ps.stored[i] = 0;
    }
    ps.live[i] = ps.jump[i] = 0;
    ps.jump_at_break[i] = -1;
    any = true;
  }
  return any;
}

}  // namespace

namespace {

/// Raise what several threads may raise at once.
void raise_to(Real& most, Real value) {
  const std::atomic_ref shared(most);
  Real now = shared.load(std::memory_order_relaxed);
  while (now < value && !shared.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

}  // namespace

/// Stiffness of live bonds on each node, and what contacts of its exposed faces may come to before
/// the next refresh.
void sum_stiffness(const Model& m, State& s) {
  s.node_bonds.resize(m.node_count);
  s.node_bonds.fill(0);
  const auto conforming = [&](const PairSet& p, const PairState& ps) {
    for (Index i = 0; i < p.count; ++i) {
      if (!(ps.live[i] > 0)) continue;
      const Real k = std::max(p.stiffness[i], p.stiffness[std::size_t(p.stride) + i]);
      for (Index c = 0; c < 2 * p.points; ++c)
        s.node_bonds[p.nodes[std::size_t(c) * p.stride + i]] += k * p.area[i] / p.points;
    }
  };
  conforming(m.triangles, s.triangles);
  conforming(m.quads, s.quads);
  const PairSet& p = m.overlaps;
  for (Index i = 0; i < p.count; ++i) {
    if (!(s.overlaps.live[i] > 0)) continue;
    const Real k = std::max(p.stiffness[i], p.stiffness[std::size_t(p.stride) + i]);
    for (Index c = p.point_first[i]; c < p.point_first[i + 1]; ++c)
      for (Index v = 0; v < 4; ++v) {
        const Index a = m.face_nodes[4 * p.faces[2 * i] + v];
        const Index b = m.face_nodes[4 * p.faces[2 * i + 1] + v];
        if (a >= 0) s.node_bonds[a] += k * p.point_area[c] * std::abs(p.weights_a[4 * c + v]);
        if (b >= 0) s.node_bonds[b] += k * p.point_area[c] * std::abs(p.weights_b[4 * c + v]);
      }
  }

  s.node_potential.resize(m.node_count);
  s.node_potential.fill(0);
  const FaceColumns faces = face_columns(m, s);
  const ContactLaws laws = contact_laws(m, s);
  const FaceGeometry geometry = face_geometry(s);
  const Index exposed = Index(s.search.exposed_face.size());
  std::vector<Real> stiffest_of(exposed);  // contact that a face may have  [N/m]
#pragma omp parallel for schedule(static, 128) if (exposed >= worth_threads)
  for (Index y = 0; y < exposed; ++y)
    for (Index c = s.search.source_first[y]; c < s.search.source_first[y + 1]; ++c) {
      const Index x = s.search.source[c];
      const auto stiffness = laws.stiffness(geometry, laws.between(geometry, x, y), x, y);
      for (const Index face : {x, y})
        raise_to(stiffest_of[face], std::max(stiffness.n, stiffness.s));
    }
  for (Index x = 0; x < exposed; ++x) {  // either side's semi-springs, as much again for semi-edges
    const Index face = s.search.exposed_face[x];
    for (Index v = 0; v < faces.vertex_count(face); ++v)
      s.node_potential[faces.vertex(face, v)] += 2 * stiffest_of[x];
  }
}

bool refresh_is_due(const Model& m, State& s) {
  s.search.strayed = false;
  if (s.built_step < 0) return true;
  if (m.refresh_interval > 0) return s.step - s.built_step >= m.refresh_interval;
  if (release_is_due(m, m.triangles, s.triangles) || release_is_due(m, m.quads, s.quads) ||
      release_is_due(m, m.overlaps, s.overlaps))
    return true;
  SearchState& search = s.search;
  return search.strayed = any_strayed(s, search.watch, search.built_time, search.horizon);
}

void list_exposed(const Model& m, State& s) {
  const SearchState& search = s.search;
  const std::size_t count = search.exposed_face.size();
  s.search.exposed.resize(count);
  for (std::size_t x = 0; x < count; ++x) {
    const Index face = search.exposed_face[x];
    ExposedRow& row = s.search.exposed[x];
    const Index* nodes = m.face_nodes.data() + 4 * std::size_t(face);
    for (Index k = 0; k < 4; ++k) {
      const Index across = search.across[4 * x + k];
      row.corner[k] = nodes[k] < 0 ? nodes[2] : nodes[k];
      row.beside[k] = across < 0 ? -1 : search.face_exposed[across];
    }
    row.reach = m.face_reach[face];
    row.area = m.face_area[face] / row.count();
    row.stiffness = m.face_stiffness[face];
    row.group = m.face_group[face];
  }
}

void refresh_contacts(const Model& m, State& s) {
  if (s.built_step < 0) {
    s.search.face_exposed.resize(m.face_count, -1);
    for (Index f = 0; f < m.face_count; ++f)
      if (m.face_initially_exposed[f]) expose(s, f);
  }
  open_hinges<3>(m, s, m.triangles, s.triangles, m.bond_indentation_triangle);
  open_hinges<4>(m, s, m.quads, s.quads, m.bond_indentation_quad);
  bool released = s.built_step < 0;
  released = release_pairs(m, s, m.triangles, s.triangles) || released;
  released = release_pairs(m, s, m.quads, s.quads) || released;
  released = release_pairs(m, s, m.overlaps, s.overlaps) || released;
  sort_exposed(s);
  join_surfaces(m, s, released);
  list_exposed(m, s);
  list_candidates(m, s);
  sum_stiffness(m, s);
  if (released) list_corners(m, s);
  list_contact_corners(m, s);
  if (!s.all_awake) list_awake_nodes(m, s);
  s.built_step = s.step;
  ++s.refreshes;
}

bool may_have_contacts(const State& s) {
  return s.search.source.size() > 0 || s.built_step == s.step;
}

void update_face_geometry(const Model& m, State& s, Queue q, bool all) {
  if (!all && !may_have_contacts(s)) return;
  const Index count = Index(s.search.exposed_face.size());
  const Index* exposed = s.search.exposed_face.data();
  launch_one(q, count,
             UpdateFaceGeometry{face_columns(m, s), exposed, s.search.exposed.data(),
                                s.face_geometry.data()});
  launch_one(q, count,
             MarkSharpSides{face_columns(m, s), all ? nullptr : s.search.face_listed.data(),
                            s.search.exposed.data(), s.face_geometry.data()});
}

Real adopt_overlaps(const Model& m, State& s, Index& count, Index& face) {
  constexpr Real reported = 1e-6;  // of L: shallower overlaps are round-off of the mesh
  SearchRules deep = m.rules;
  deep.entry = deep.depth;
  update_face_geometry(m, s, {}, true);
  list_close(m, s, {});
  FindTargetFaces search{face_search(m, s)};
  search.rules = deep;
  const Index exposed = Index(s.search.exposed_face.size());
  Real deepest = 0;
  count = 0;
  face = -1;
  for (Index x = 0; x < exposed; ++x) {
    const Index mother = s.search.exposed_face[x];
    for (Index k = 0; k < search.faces.vertex_count(mother); ++k) {
      Index& t = s.springs.target[4 * x + k];
      s.springs.target_before[4 * x + k] = t;
      t = search.choose(x, k, search.listed_for(4 * x + k), &s.springs.lost[4 * x + k]);
      if (t < 0) continue;
      const FaceShape<Real> shape = search.faces.shape(s.search.exposed_face[t]);
      const Vec3<Real> v = search.faces.nodes.position(search.faces.vertex(mother, k));
      const Real gap = project(shape, v, shape.normal()).gap;
      ContactState spring{};
      spring.gap_free = gap;
      spring.store(s.springs.state.data(), 4 * x + k);
      s.springs.target_before[4 * x + k] = t;
      if (gap > -reported * m.face_length[mother]) continue;
      ++count;
      if (-gap > deepest) deepest = -gap, face = mother;
    }
  }
  return deepest;
}

namespace {

/// Boxes of the sides of exposed faces, [exposed][4], with room for any depth of contact: sides
/// whose boxes are apart cannot touch.
std::vector<Box> side_boxes(const Model& m, const State& s) {
  const FaceColumns faces = face_columns(m, s);
  const Index count = Index(s.search.exposed_face.size());
  std::vector<Box> boxes(4 * std::size_t(count), Box::nothing());
  for (Index x = 0; x < count; ++x) {
    const Index face = s.search.exposed_face[x], corners = faces.vertex_count(face);
    for (Index k = 0; k < corners; ++k) {
      const Index ends[2] = {faces.vertex(face, k),
                             faces.vertex(face, k + 1 == corners ? 0 : k + 1)};
      Box& box = boxes[4 * std::size_t(x) + k];
      Real speed = 0;
      for (const Index node : ends) {
        box.include(faces.nodes.position(node));
        speed = std::max(speed, norm(faces.nodes.velocity(node)));
      }
      const Real slack = m.rules.indentation * 2 * m.face_reach[face];  // more than it is long
      box.inflate(m.rules.depth * m.face_length[face] + slack +
                  m.rules.approach_steps * faces.dt * speed);
    }
  }
  return boxes;
}

}  // namespace

Index count_missed_contacts(const Model& m, State& s) {
  update_face_geometry(m, s, {}, true);
  finish({});
  const FindTargetFaces springs{face_search(m, s)};
  const TouchTargetEdges edges = edge_search(m, s);
  const Index count = Index(s.search.exposed_face.size());
  const Bonded bonded = live_overlaps(m, s);
  const auto block = [&](Index x) { return m.face_block[s.search.exposed_face[x]]; };
  const auto movable = [&](Index x) { return m.face_movable[s.search.exposed_face[x]] != 0; };
  // spheres around two faces, with room for any depth of contact: what is farther off cannot touch
  const auto near = [&](Index x, Index t) {
    const Index face = s.search.exposed_face[x], other = s.search.exposed_face[t];
    const Vec3<Real> apart = springs.geometry.center(x) - springs.geometry.center(t);
    const Real reach =
        m.face_reach[face] + m.face_reach[other] + m.face_length[face] + m.face_length[other];
    return dot(apart, apart) < reach * reach;
  };
  const std::vector<Box> sides = side_boxes(m, s);
  Index missed = 0;
#pragma omp parallel for schedule(dynamic, 8) reduction(+ : missed)
  for (Index x = 0; x < count; ++x) {
    std::vector<Index> all, open;
    for (Index t = 0; t < count; ++t)
      if (block(t) != block(x) && (movable(t) || movable(x)) && near(x, t) &&
          !Bonded::among(bonded.faces, x, t))
        all.push_back(t);
    Flag ignored = 0;
    for (Index k = 0; k < springs.faces.vertex_count(s.search.exposed_face[x]); ++k) {
      const Index node = springs.faces.vertex(s.search.exposed_face[x], k);
      open.clear();
      std::copy_if(all.begin(), all.end(), std::back_inserter(open),
                   [&](Index t) { return !Bonded::among(bonded.vertices, node, t); });
      const FaceList list{open.data(), nullptr, Index(open.size())};
      missed += s.springs.target[4 * x + k] != springs.choose(x, k, list, &ignored);
    }
    if (!m.semi_edges) continue;
    const auto touch = [&](Index t, Index k, Index j) {
      SidePair pair;
      const Index face = s.search.exposed_face[x], other = s.search.exposed_face[t];
      if (!pair_sides(edges.faces, face, k, other, j, pair)) return false;
      const Index edge = m.face_edges[4 * other + j];
      return edges.test(TwoSides<Index>{x, t, pair.code(), edges.held_place(x, k, edge)}).touches;
    };
    const auto found = [&](Index t, Index k, Index j) {
      for (Index c = s.edges.first[x]; c < s.edges.first[x + 1]; ++c) {
        const EdgeContact contact = EdgeContact::at(s.edges.contact.data(), c);
        if (contact.mother == 4 * x + k && contact.face == t &&
            contact.edge == m.face_edges[4 * s.search.exposed_face[t] + j])
          return true;
      }
      return false;
    };
    Index known = 0;  // of those that are listed
    for (const Index t : all)
      for (Index k = 0; k < edges.faces.vertex_count(s.search.exposed_face[x]); ++k)
        for (Index j = 0; j < edges.faces.vertex_count(s.search.exposed_face[t]); ++j) {
          if (!sides[4 * std::size_t(x) + k].overlaps(sides[4 * std::size_t(t) + j])) continue;
          if (touch(t, k, j)) found(t, k, j) ? ++known : ++missed;
        }
    missed += s.edges.first[x + 1] - s.edges.first[x] - known;
  }
  return missed;
}

}  // namespace cdem
