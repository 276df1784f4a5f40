// wet_faces.cpp - see wet_faces.hpp.
#include "core/water/wet_faces.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/base/views.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// What presses on the vertices of faces of one set.
class Vertices {
 public:
  Vertices(const Model& m, const State& s, const WetFaces& w)
      : m_(m), s_(s), w_(w), dry_(Index(m.water.fields.size() / 8) - 1) {}

  void find(Index f, Index* field, Index stride) const {
    const Index face = w_.face[f];
    const bool out = is_out(face), bonded = !out && is_bonded(f);
    for (Index k = 0; k < w_.vertices; ++k) {
      Index& of_vertex = field[std::size_t(k) * stride + f];
      if (out)
        of_vertex = dry_;
      else if (bonded)
        of_vertex = w_.bonded[f] ? w_.joint[f] : dry_;
      else
        of_vertex = is_closed(f, k) ? w_.joint[f] : w_.open[f];
    }
  }

 private:
  Index vertex(Index face, Index k) const { return m_.face_nodes[4 * face + k]; }
  bool is_out(Index face) const {
    return s_.nodes.out.size() > 0 && s_.nodes.out[vertex(face, 0)] != 0;
  }
  Range pairs_of(Index f) const { return {w_.pair_first[f], w_.pair_first[f + 1]}; }

  /// Call ask(pair set, its state, pair) for the pairs of a face until one says yes.
  template <class Ask>
  bool any_pair(Index f, const Ask& ask) const {
    const Range pairs = pairs_of(f);
    for (Index c = pairs.first; c < pairs.last; ++c) {
      if (w_.pair[c] < 0) continue;
      const Index kind = w_.pair[c] % 3, pair = w_.pair[c] / 3;
      const bool yes = kind == 0   ? ask(m_.triangles, s_.triangles, pair)
                       : kind == 1 ? ask(m_.quads, s_.quads, pair)
                                   : ask(m_.overlaps, s_.overlaps, pair);
      if (yes) return true;
    }
    return false;
  }
  /// Does a bond point of a pair of the face hold?
  bool is_bonded(Index f) const {
    return any_pair(f, [](const PairSet&, const PairState& ps, Index i) {
      return is_live(PairStatus(ps.status[i])) && !(ps.jump_at_break[i] >= 0);
    });
  }
  bool is_closed(Index f, Index k) const {
    if (touches(w_.face[f], k)) return true;
    const Vec3<Real> x = position(w_.nodes[std::size_t(k) * w_.stride + f]);
    const Range mates = pairs_of(f);
    for (Index c = mates.first; c < mates.last; ++c)
      if (is_near(x, w_.mate[c], w_.aperture[f])) return true;
    return false;
  }
  /// Does a vertex of a face touch another one that the face lies on? A face that only stands on it
  /// is outside the joint.
  bool touches(Index face, Index k) const {
    const Index place = s_.search.face_exposed.size() > 0 ? s_.search.face_exposed[face] : -1;
    if (place < 0) return false;
    const Index target = s_.springs.target[4 * std::size_t(place) + k];
    constexpr Real opposite = -0.7;  // cosine between the normals
    return target >= 0 && dot(normal(face), normal(s_.search.exposed_face[target])) < opposite;
  }
  /// Is a place no farther than the aperture in front of a face, and over it?
  bool is_near(const Vec3<Real>& x, Index face, Real aperture) const {
    if (is_out(face)) return false;
    Vec3<Real> middle{0, 0, 0};
    for (Index k = 0; k < count(face); ++k) middle = middle + position(vertex(face, k));
    middle = (1.0 / count(face)) * middle;
    const Vec3<Real> n = normal(face);
    const Real away = dot(n, x - middle);
    const Real reach = m_.face_reach[face];  // behind it by more, it is beside another face
    return away < aperture && away > -reach && norm(x - middle - away * n) <= reach;
  }

  Index count(Index face) const { return vertex(face, 3) < 0 ? 3 : 4; }
  Vec3<Real> position(Index node) const { return InMotion{s_.nodes.motion.data()}.position(node); }
  Vec3<Real> normal(Index face) const {
    const Vec3<Real> x0 = position(vertex(face, 0)), x1 = position(vertex(face, 1)),
                     x2 = position(vertex(face, 2)), x3 = position(vertex(face, count(face) - 1));
    return unit(cross(x2 - x0, x3 - x1));
  }

  const Model& m_;
  const State& s_;
  const WetFaces& w_;
  Index dry_;
};

}  // namespace

void find_wet_faces(const Model& m, State& s) {
  const auto find = [&](const WetFaces& w, Column<Index>& field) {
    field.resize(std::size_t(w.vertices) * w.stride);
    const Vertices vertices(m, s, w);
#pragma omp parallel for schedule(static, 128) if (w.count >= worth_threads)
    for (Index f = 0; f < w.count; ++f) vertices.find(f, field.data(), w.stride);
  };
  find(m.water.triangles, s.water.triangle_field);
  find(m.water.quads, s.water.quad_field);
}

}  // namespace cdem
