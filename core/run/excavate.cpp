// excavate.cpp - see excavate.hpp.
#include "core/run/excavate.hpp"

#include <array>
#include <vector>

#include "core/contact/geometry/views.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/applied.hpp"
#include "core/run/take_out.hpp"

namespace cdem {

namespace {

/// Forces of the last step from removed blocks on remaining ones.
class KeptForces {
 public:
  KeptForces(const Model& m, State& s, const Flag* leaves)
      : m_(m),
        s_(s),
        leaves_(leaves),
        exposed_face_(on_host(s.search.exposed_face)),
        face_nodes_(on_host(m.face_nodes)),
        out_(on_host(s.nodes.out)),
        relief_(on_host(s.nodes.relief)),
        corner_force_(on_host(s.corner_force)) {}

  void add_pairs() {
    for_each_pair_set(m_, s_, [&](auto, const PairSet& p, const PairState& ps) {
      const auto is_active = activity(ps);
      const auto faces = on_host(p.faces), nodes = on_host(p.nodes);
      for (Index i = 0; i < p.count; ++i) {
        const Index a = faces[2 * i], b = faces[2 * i + 1];
        if (!is_active(i) || leaves(a) == leaves(b)) continue;
        conforms(p) ? add_conforming(p, nodes, i) : add_overlap(p, {a, b}, i);
      }
    });
  }
  void add_springs() {
    const auto targets = on_host(s_.springs.target);
    const auto reaction = on_host(s_.springs.reaction), rim_action = on_host(s_.springs.rim_action);
    for (Index slot = 0; slot < Index(targets.size()); ++slot) {
      const Index target = targets[slot];
      if (target < 0) continue;
      const Index x = face(slot / 4), y = face(target), count = vertex_count(x);
      const Real* row = reaction.data() + 8 * std::size_t(slot);
      const Vec3<Real> f = Row::at(row).vector();
      if (leaves(y)) {
        const Real action = std::max(m_.rules.action, rim_action[slot]);
        add(vertex(x, slot % 4), 1 - action, f);
        for (Index k = 0; k < count; ++k) add(vertex(x, k), action / count, f);
      } else if (leaves(x)) {
        for (Index k = 0; k < vertex_count(y); ++k) add(vertex(y, k), -row[4 + k], f);
      }
    }
  }
  void add_edges() {
    const FaceColumns faces = on_host(face_columns(m_, s_));
    const auto contacts = on_host(s_.edges.contact);
    const auto reaction = on_host(s_.edges.reaction);
    for (std::size_t c = 0; c < contacts.size() / 4; ++c) {
      const EdgeContact contact = EdgeContact::at(contacts.data(), c);
      const Index x = face(contact.mother / 4), y = face(contact.face);
      const Real* row = reaction.data() + 8 * c;
      const Vec3<Real> f = Row::at(row).vector();
      if (leaves(y))
        add_side(x, contact.mother % 4, 1 - row[4], row[4], f);
      else if (leaves(x))
        add_side(y, faces.side_on(y, contact.edge), row[5] - 1, -row[5], f);
    }
  }

 private:
  Index face(Index exposed) const { return exposed_face_[exposed]; }
  Index vertex(Index face, Index k) const { return face_nodes_[4 * face + k]; }
  Index vertex_count(Index face) const { return vertex(face, 3) < 0 ? 3 : 4; }
  bool leaves(Index face) const { return leaves_[vertex(face, 0)] != 0; }

  /// It does not matter for removed blocks, now or earlier.
  void add(Index node, Real weight, const Vec3<Real>& f) {
    if (leaves_[node] || (out_.size() > 0 && out_[node])) return;
    Real* row = relief_.data() + 4 * std::size_t(node);
    row[0] += weight * f.x, row[1] += weight * f.y, row[2] += weight * f.z;
  }
  void add_side(Index face, Index side, Real first, Real second, const Vec3<Real>& f) {
    add(vertex(face, side), first, f);
    add(vertex(face, side + 1 == vertex_count(face) ? 0 : side + 1), second, f);
  }
  Vec3<Real> force_of_row(std::size_t row) const {
    return Row::at(corner_force_.data() + 4 * row).vector();
  }
  void add_conforming(const PairSet& p, OnHost<const Index> nodes, Index i) {
    for (Index k = 0; k < p.points; ++k) {
      const Vec3<Real> f =
          force_of_row(std::size_t(p.corner_first) + std::size_t(p.points) * i + k);
      add(nodes[std::size_t(k) * p.stride + i], -1, f);
      add(nodes[std::size_t(p.points + k) * p.stride + i], 1, f);
    }
  }
  void add_overlap(const PairSet& p, const std::array<Index, 2>& faces, Index i) {
    for (Index k = 0; k < 8; ++k) {
      const Index node = vertex(faces[k / 4], k % 4);
      if (node >= 0)
        add(node, 1, force_of_row(std::size_t(p.corner_first) + 8 * std::size_t(i) + k));
    }
  }

  const Model& m_;
  State& s_;
  const Flag* leaves_;
  OnHost<Index> exposed_face_;
  OnHost<const Index> face_nodes_;
  OnHost<Flag> out_;
  OnHost<Real> relief_, corner_force_;
};

}  // namespace

void excavate(Model& m, State& s, const Flag* leaves) {
  const Real left = s.relief.at(s.time);
  s.nodes.relief.resize(4 * std::size_t(m.node_count));
  const auto relief = on_host(s.nodes.relief);
  for (std::size_t k = 0; k < relief.size(); ++k) relief[k] *= leaves[k / 4] ? 0 : left;
  if (s.step > 0) {  // before the first step nothing bears
    KeptForces kept(m, s, leaves);
    kept.add_pairs();
    kept.add_springs();
    kept.add_edges();
  }
  s.relief = {};
  take_out(m, s, leaves);
  if (s.step == 0) return;
  const std::vector<Real> change = change_applied(m, s);
  const auto now = on_host(s.nodes.relief);
  for (std::size_t k = 0; k < change.size(); ++k)
    if (!leaves[k / 4]) now[k] -= change[k];
}

void release_forces(State& s, Real part, Real end_time) {
  s.relief = {.begin = s.time, .end = end_time, .from = s.relief.at(s.time), .to = part};
}

}  // namespace cdem
