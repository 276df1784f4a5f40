// vertex_face.hpp - a vertex and a face that it may touch.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Faces of the inner list that a vertex of an exposed face may touch: ragged rows.
struct Candidates {
  const Index* first;  // [4 * exposed + 1], slot = 4 * exposed face + vertex
  const Index* other;  // exposed face, ascending in a row
  const Flag* rises;   // of those: may the surface rise at a side of the face?
  Flag* may_begin;     // of those, see FilterNewTargets
};

/// Some of them.
struct FaceList {
  const Index* other;
  const Flag* may_begin;  // null: all are to be looked at
  Index count;
  CDEM_HD bool takes(Index c) const { return !may_begin || may_begin[c]; }
};

/// A vertex of an exposed face and a face that it may touch, or one a lane.
template <class T>
struct VertexFace {
  Vec3<T> v, p;             // true vertex; indented point v + alpha (C - v), Eq. 3  [m]
  Vec3<T> center, normal;   // of the target
  T length, target_length;  // L: the smaller of both; the target's, < 0 for a quadrilateral  [m]
  Truth<T> opposes;

  template <class Ids>
  CDEM_HD static VertexFace at(const FaceColumns& faces, const FaceGeometry& geometry,
                               const SearchRules& rules, const Ids& m, const Ids& node,
                               const Ids& t) {
    const auto of_m = geometry.row(m), of_t = geometry.row(t);
    VertexFace pair;
    pair.v = faces.nodes.position(node);
    pair.p = pair.v + T(rules.indentation) * (of_m.center - pair.v);
    pair.center = of_t.center;
    pair.normal = of_t.normal;
    pair.target_length = of_t.length;
    pair.length = min_of(abs_of(of_m.length), abs_of(of_t.length));
    pair.opposes = dot(of_m.normal, of_t.normal) < T(-rules.opposing);
    return pair;
  }
};

/// The vertex of exposed face m that a candidate is of; `first` is of all slots.
CDEM_HD inline Index vertex_of(const Index* first, Index m, Index candidate) {
  const Index* row = first + 4 * m;
  return (candidate >= row[1]) + (candidate >= row[2]) + (candidate >= row[3]);
}

}  // namespace cdem
