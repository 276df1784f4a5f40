// wet_faces.cpp - see wet_faces.hpp.
#include "core/water/wet_faces.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/base/views.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Pressure at the vertices of faces of one set.
class Vertices {
 public:
  Vertices(const Model& m, const State& s, const WetFaces& w)
      : w_(w),
        dry_(Index(given_of<Water>(m).fields.size() / 8) - 1),
        face_nodes_(on_host(m.face_nodes)),
        face_exposed_(on_host(s.search.face_exposed)),
        exposed_face_(on_host(s.search.exposed_face)),
        target_(on_host(s.springs.target)),
        out_(on_host(s.nodes.out)),
        reach_(on_host(m.face_reach)),
        nodes_(on_host(InMotion{s.nodes.motion.data()})),
        face_(on_host(w.face)),
        joint_(on_host(w.joint)),
        open_(on_host(w.open)),
        pair_first_(on_host(w.pair_first)),
        pair_(on_host(w.pair)),
        mate_(on_host(w.mate)),
        vertex_(on_host(w.nodes)),
        bonded_(on_host(w.bonded)),
        aperture_(on_host(w.aperture)),
        bonds_{Bonds(s.triangles), Bonds(s.quads), Bonds(s.overlaps)} {}

  void find(Index f, Index* field, Index stride) const {
    const Index face = face_[f];
    const bool out = is_out(face), bonded = !out && is_bonded(f);
    for (Index k = 0; k < w_.vertices; ++k) {
      Index& of_vertex = field[std::size_t(k) * stride + f];
      if (out)
        of_vertex = dry_;
      else if (bonded)
        of_vertex = bonded_[f] ? joint_[f] : dry_;
      else
        of_vertex = is_closed(f, k) ? joint_[f] : open_[f];
    }
  }

 private:
  /// Of the pairs of a set.
  struct Bonds {
    OnHost<const Flag> status;
    OnHost<const Real> jump_at_break;
    explicit Bonds(const PairState& ps)
        : status(on_host(ps.status)), jump_at_break(on_host(ps.jump_at_break)) {}
    bool hold(Index pair) const {
      return is_live(PairStatus(status[pair])) && !(jump_at_break[pair] >= 0);
    }
  };

  Index vertex(Index face, Index k) const { return face_nodes_[4 * face + k]; }
  bool is_out(Index face) const { return out_.size() > 0 && out_[vertex(face, 0)] != 0; }
  Range pairs_of(Index f) const { return {pair_first_[f], pair_first_[f + 1]}; }

  /// Does a bond point of a pair of the face hold?
  bool is_bonded(Index f) const {
    const Range pairs = pairs_of(f);
    for (Index c = pairs.first; c < pairs.last; ++c)
      if (pair_[c] >= 0 && bonds_[pair_[c] % 3].hold(pair_[c] / 3)) return true;
    return false;
  }
  bool is_closed(Index f, Index k) const {
    if (touches(face_[f], k)) return true;
    const Vec3<Real> x = nodes_.position(vertex_[std::size_t(k) * w_.stride + f]);
    const Range mates = pairs_of(f);
    for (Index c = mates.first; c < mates.last; ++c)
      if (is_near(x, mate_[c], aperture_[f])) return true;
    return false;
  }
  /// Does a vertex of a face touch another one that the face lies on? A face that only stands on it
  /// is outside the joint.
  bool touches(Index face, Index k) const {
    const Index place = face_exposed_.size() > 0 ? face_exposed_[face] : -1;
    if (place < 0) return false;
    const Index target = target_[4 * std::size_t(place) + k];
    constexpr Real opposite = -0.7;  // cosine between the normals
    return target >= 0 && dot(normal(face), normal(exposed_face_[target])) < opposite;
  }
  /// Is a place no farther than the aperture in front of a face, and over it?
  bool is_near(const Vec3<Real>& x, Index face, Real aperture) const {
    if (is_out(face)) return false;
    Vec3<Real> middle{0, 0, 0};
    for (Index k = 0; k < count(face); ++k) middle = middle + position(face, k);
    middle = (1.0 / count(face)) * middle;
    const Vec3<Real> n = normal(face);
    const Real away = dot(n, x - middle);
    const Real reach = reach_[face];  // behind it by more, it is beside another face
    return away < aperture && away > -reach && norm(x - middle - away * n) <= reach;
  }

  Vec3<Real> position(Index face, Index k) const { return nodes_.position(vertex(face, k)); }
  Index count(Index face) const { return vertex(face, 3) < 0 ? 3 : 4; }
  Vec3<Real> normal(Index face) const {
    const Vec3<Real> x0 = position(face, 0), x1 = position(face, 1), x2 = position(face, 2),
                     x3 = position(face, count(face) - 1);
    return unit(cross(x2 - x0, x3 - x1));
  }

  const WetFaces& w_;
  Index dry_;
  OnHost<const Index> face_nodes_, face_exposed_, exposed_face_, target_;
  OnHost<const Flag> out_;
  OnHost<const Real> reach_;
  InMotion nodes_;
  OnHost<const Index> face_, joint_, open_, pair_first_, pair_, mate_, vertex_;  // of wet faces
  OnHost<const Flag> bonded_;
  OnHost<const Real> aperture_;
  Bonds bonds_[3];  // by kind of pairs
};

}  // namespace

void find_wet_faces(const Model& m, State& s) {
  const auto find = [&](const WetFaces& w, Column<Index>& field) {
    field.resize(std::size_t(w.vertices) * w.stride);
    const auto fields = on_host(field);
    const Vertices vertices(m, s, w);
#pragma omp parallel for schedule(static, 128) if (w.count >= worth_threads)
    for (Index f = 0; f < w.count; ++f) vertices.find(f, fields.data(), w.stride);
  };
  const WaterSet& w = given_of<Water>(m);
  find(w.triangles, state_of<Water>(s).triangle_field);
  find(w.quads, state_of<Water>(s).quad_field);
}

}  // namespace cdem
