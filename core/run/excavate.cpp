// excavate.cpp - see excavate.hpp.
#include "core/run/excavate.hpp"

#include "core/contact/geometry/views.hpp"
#include "core/model/force_sets.hpp"
#include "core/run/take_out.hpp"
#include "core/water/water.hpp"

namespace cdem {

namespace {

/// Forces of the last step that what leaves puts on what stays.
class KeptForces {
 public:
  KeptForces(const Model& m, State& s, const Flag* leaves) : m_(m), s_(s), leaves_(leaves) {}

  void add_pairs() {
    for_each_pair_set(m_, s_, [&](auto, const PairSet& p, const PairState& ps) {
      for (Index i = 0; i < p.count; ++i)
        if (is_live(PairStatus(ps.status[i])))
          conforms(p) ? add_conforming(p, i) : add_overlap(p, i);
    });
  }
  void add_springs() {
    for (Index slot = 0; slot < Index(s_.springs.target.size()); ++slot) {
      const Index target = s_.springs.target[slot];
      if (target < 0) continue;
      const Index x = face(slot / 4), y = face(target), count = vertex_count(x);
      const Real* row = s_.springs.reaction.data() + 8 * std::size_t(slot);
      const Vec3<Real> f = Row::at(row).vector();
      if (leaves(y)) {
        add(vertex(x, slot % 4), 1 - m_.rules.action, f);
        for (Index k = 0; k < count; ++k) add(vertex(x, k), m_.rules.action / count, f);
      } else if (leaves(x)) {
        for (Index k = 0; k < vertex_count(y); ++k) add(vertex(y, k), -row[4 + k], f);
      }
    }
  }
  void add_edges() {
    const FaceColumns faces = face_columns(m_, s_);
    for (std::size_t c = 0; c < s_.edges.contact.size() / 4; ++c) {
      const EdgeContact contact = EdgeContact::at(s_.edges.contact.data(), c);
      const Index x = face(contact.mother / 4), y = face(contact.face);
      const Real* row = s_.edges.reaction.data() + 8 * c;
      const Vec3<Real> f = Row::at(row).vector();
      if (leaves(y))
        add_side(x, contact.mother % 4, 1 - row[4], row[4], f);
      else if (leaves(x))
        add_side(y, faces.side_on(y, contact.edge), row[5] - 1, -row[5], f);
    }
  }

 private:
  Index face(Index exposed) const { return s_.search.exposed_face[exposed]; }
  Index vertex(Index face, Index k) const { return m_.face_nodes[4 * face + k]; }
  Index vertex_count(Index face) const { return vertex(face, 3) < 0 ? 3 : 4; }
  bool leaves(Index face) const { return leaves_[vertex(face, 0)] != 0; }

  /// Of what leaves it does not matter, nor of what left before.
  void add(Index node, Real weight, const Vec3<Real>& f) {
    if (leaves_[node] || (s_.nodes.out.size() > 0 && s_.nodes.out[node])) return;
    Real* row = s_.nodes.relief.data() + 4 * std::size_t(node);
    row[0] += weight * f.x, row[1] += weight * f.y, row[2] += weight * f.z;
  }
  void add_side(Index face, Index side, Real first, Real second, const Vec3<Real>& f) {
    add(vertex(face, side), first, f);
    add(vertex(face, side + 1 == vertex_count(face) ? 0 : side + 1), second, f);
  }
  Vec3<Real> force_of_row(std::size_t row) const {
    return Row::at(s_.corner_force.data() + 4 * row).vector();
  }
  bool parts(const PairSet& p, Index i) const {
    return leaves(p.faces[2 * i]) != leaves(p.faces[2 * i + 1]);
  }
  void add_conforming(const PairSet& p, Index i) {
    if (!parts(p, i)) return;
    for (Index k = 0; k < p.points; ++k) {
      const Vec3<Real> f =
          force_of_row(std::size_t(p.corner_first) + std::size_t(p.points) * i + k);
      add(p.nodes[std::size_t(k) * p.stride + i], -1, f);
      add(p.nodes[std::size_t(p.points + k) * p.stride + i], 1, f);
    }
  }
  void add_overlap(const PairSet& p, Index i) {
    if (!parts(p, i)) return;
    for (Index k = 0; k < 8; ++k) {
      const Index node = vertex(p.faces[2 * i + k / 4], k % 4);
      if (node >= 0)
        add(node, 1, force_of_row(std::size_t(p.corner_first) + 8 * std::size_t(i) + k));
    }
  }

  const Model& m_;
  State& s_;
  const Flag* leaves_;
};

}  // namespace

void excavate(Model& m, State& s, const Flag* leaves) {
  const Real left = s.relief.at(s.time);
  s.nodes.relief.resize(4 * std::size_t(m.node_count));
  for (std::size_t k = 0; k < s.nodes.relief.size(); ++k)
    s.nodes.relief[k] *= leaves[k / 4] ? 0 : left;
  if (s.step > 0) {  // before the first step nothing bears
    KeptForces kept(m, s, leaves);
    kept.add_pairs();
    kept.add_springs();
    kept.add_edges();
  }
  s.relief = {};
  take_out(m, s, leaves);
  if (s.step == 0) return;
  const Column<Real> change = change_water(m, s);
  for (std::size_t k = 0; k < change.size(); ++k)
    if (!leaves[k / 4]) s.nodes.relief[k] -= change[k];
}

void let_go(State& s, Real part, Real end_time) {
  s.relief = {.begin = s.time, .end = end_time, .from = s.relief.at(s.time), .to = part};
}

}  // namespace cdem
