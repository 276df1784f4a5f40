// face.hpp - exterior faces: their vertices, frame, inside test, and the projection of a point.
#pragma once

#include "core/field.hpp"

namespace cdem {

/// Orthonormal frame: normal n (of a face: outward), and t1, t2 in the plane.
template <class T>
struct Frame {
  Vec3<T> n, t1, t2;
};

/// Is a point's projection outside a side of a face by more than `room` [m]? Eq. 7-8 with a length
/// instead of a sign, without a root.
template <class T>
CDEM_HD inline Truth<T> outside(const Vec3<T>& start, const Vec3<T>& side, const Vec3<T>& n,
                                const Vec3<T>& point, const T& room) {
  const T out = -dot(cross(n, side), point - start);  // times the length of the side
  return (out > T(0.0)) & (out * out > room * room * dot(side, side));
}

/// A face at one instant, or one a lane. The fourth vertex of a triangle repeats its third, so that
/// the normal is the cross product of the diagonals for both kinds, and both have four sides.
template <class T>
struct FaceShape {
  Vec3<T> x[4];
  Truth<T> quad;

  CDEM_HD Index count() const { return quad ? 4 : 3; }
  CDEM_HD Vec3<T> center() const {
    const Vec3<T> sum = x[0] + x[1] + x[2];
    return select(quad, T(1.0 / 4.0) * (sum + x[3]), T(1.0 / 3.0) * sum);
  }
  CDEM_HD Vec3<T> normal() const { return unit(cross(x[2] - x[0], x[3] - x[1])); }
  CDEM_HD Frame<T> frame() const { return frame(normal()); }
  CDEM_HD Frame<T> frame(const Vec3<T>& n) const {
    const Vec3<T> side = x[1] - x[0];
    const Vec3<T> t1 = unit(side - dot(n, side) * n);
    return {n, t1, cross(n, t1)};
  }
  /// Is a point's projection inside, or outside by no more than `room` [m]?
  CDEM_HD Truth<T> inside(const Vec3<T>& point, const Vec3<T>& n, const T& room) const {
    return !(
        outside(x[0], x[1] - x[0], n, point, room) | outside(x[1], x[2] - x[1], n, point, room) |
        outside(x[2], x[3] - x[2], n, point, room) | outside(x[3], x[0] - x[3], n, point, room));
  }
};

/// A point seen from a face: weights on the face's vertices and distance along the normal, so that
/// point = sum_j weight_j x_j + gap n.
template <class T>
struct Projection {
  T weight[4];
  T gap;
};

template <class T>
CDEM_HD inline Projection<T> project_on_triangle(const FaceShape<T>& f, const Vec3<T>& point,
                                                 const Vec3<T>& n) {
  const Vec3<T> a = f.x[1] - f.x[0], b = f.x[2] - f.x[0], p = point - f.x[0];
  const T twice_area = dot(cross(a, b), n);
  const T u = dot(cross(p, b), n) / twice_area;
  const T v = dot(cross(a, p), n) / twice_area;
  return {{T(1.0) - u - v, u, v, T(0.0)}, dot(n, p)};
}

/// Newton on the bilinear surface, seen from its first vertex so that round-off does not grow with
/// the distance from the origin. A parallelogram takes one step, and one that shows it; the error
/// falls with the square of the step before, so a small step is the last.
template <class T>
CDEM_HD inline Projection<T> project_on_quad(const FaceShape<T>& f, const Vec3<T>& point,
                                             const Vec3<T>& n) {
  constexpr int most_steps = 20;
  const T last(1e-8), one(1.0);
  const Vec3<T> p = point - f.x[0], a = f.x[1] - f.x[0], b = f.x[3] - f.x[0];
  const Vec3<T> warp = f.x[2] - f.x[3] - a;  // point at u, v: u a + v b + u v warp
  T u(0.5), v(0.5);
  Truth<T> goes_on = f.quad;
  for (int step = 0; step < most_steps && any_of(goes_on); ++step) {
    const Vec3<T> along_u = a + v * warp, along_v = b + u * warp;
    const Vec3<T> miss = p - u * along_u - v * b;
    const T per_area = one / dot(cross(along_u, along_v), n);
    const T du = dot(cross(miss, along_v), n) * per_area;
    const T dv = dot(cross(along_u, miss), n) * per_area;
    u = select(goes_on, u + du, u);
    v = select(goes_on, v + dv, v);
    goes_on = goes_on & !(abs_of(du) + abs_of(dv) < last);
  }
  const T gap = dot(n, p - u * (a + v * warp) - v * b);
  return {{(one - u) * (one - v), u * (one - v), u * v, (one - u) * v}, gap};
}

template <class T>
CDEM_HD inline Projection<T> project(const FaceShape<T>& f, const Vec3<T>& point,
                                     const Vec3<T>& n) {
  if (!any_of(f.quad)) return project_on_triangle(f, point, n);
  const Projection<T> on_quad = project_on_quad(f, point, n);
  if (!any_of(!f.quad)) return on_quad;
  Projection<T> p = project_on_triangle(f, point, n);
  for (Index j = 0; j < 4; ++j) p.weight[j] = select(f.quad, on_quad.weight[j], p.weight[j]);
  p.gap = select(f.quad, on_quad.gap, p.gap);
  return p;
}

/// Vertices of a face, or of one a lane; the fourth of a triangle repeats its third.
template <class Ids>
struct FaceVertices {
  Ids node[4];
  CDEM_HD auto quad() const { return differ(node[2], node[3]); }
};

/// The exterior faces and edges of all blocks: what never changes, and the nodes' motion.
struct FaceColumns {
  InMotion nodes;
  const Index* face_nodes;    // [face][4], the fourth is -1 for a triangle
  const Index* face_edges;    // [face][4]: the edge from vertex k to k + 1
  const Real* face_length;    // L: mean distance from the centre to the vertices, Eq. 3  [m]
  const Real* face_height;    // of the element behind  [m]
  const Index* edge_nodes;    // [edge][2]
  const Index* beyond;        // [exposed][4]: face on the other side of side k, or -1
  const Index* ring_first;    // [label + 1]
  const Index* ring;          // other ends of the edges that leave a point
  const Index* node_glue;     // label shared by nodes that intact bonds hold together
  const Index* node_place;    // label shared by nodes that began at the same place
  const Index* face_exposed;  // [face]: place in the list of exposed faces, or -1
  Real dt;                    // [s]

  CDEM_HD Index vertex_count(Index face) const { return face_nodes[4 * face + 3] < 0 ? 3 : 4; }
  CDEM_HD Index vertex(Index face, Index k) const { return face_nodes[4 * face + k]; }

  /// Which side of a face an edge of its own is.
  CDEM_HD Index side_on(Index face, Index edge) const {
    for (Index k = 0; k < 3; ++k)
      if (face_edges[4 * face + k] == edge) return k;
    return 3;
  }
  template <class Ids>
  CDEM_HD auto shape(const FaceVertices<Ids>& of) const {
    return FaceShape<Number<Ids>>{{nodes.position(of.node[0]), nodes.position(of.node[1]),
                                   nodes.position(of.node[2]), nodes.position(of.node[3])},
                                  of.quad()};
  }
  CDEM_HD FaceShape<Real> shape(Index face) const { return shape(vertices(face)); }
  /// Where a node and a face were one step ago.
  CDEM_HD Vec3<Real> position_before(Index node) const {
    return nodes.position(node) - dt * nodes.velocity(node);
  }
  CDEM_HD FaceShape<Real> shape_before(Index face) const {
    const FaceVertices<Index> of = vertices(face);
    return {{position_before(of.node[0]), position_before(of.node[1]), position_before(of.node[2]),
             position_before(of.node[3])},
            of.quad()};
  }
  /// The face on the other side of side k of an exposed face, or -1: of the same block or of one
  /// that is bonded to it there.
  CDEM_HD Index across(Index exposed, Index k) const { return beyond[4 * exposed + k]; }

 private:
  CDEM_HD FaceVertices<Index> vertices(Index face) const {
    const Index* v = face_nodes + 4 * face;
    return {{v[0], v[1], v[2], v[3] < 0 ? v[2] : v[3]}};
  }
};

/// What the search and the forces ask of an exposed face and never changes between two refreshes:
/// one cache line.
struct ExposedRow {
  Index corner[4];  // nodes; the fourth of a triangle repeats its third
  Index beside[4];  // exposed face across side k, or -1
  Real reach;       // a little more than the farthest vertex from the centre  [m]
  Real area;        // a vertex's share of the face, Eq. 4-5  [m2]
  Real stiffness;   // modulus of the element behind over its height  [Pa/m]
  Index group;
  Index unused = 0;

  CDEM_HD Index count() const { return corner[3] == corner[2] ? 3 : 4; }
  /// The vertex at the end of side k.
  CDEM_HD Index end(Index k) const { return corner[k + 1 == count() ? 0 : k + 1]; }
};

/// Centre, sharp sides, normal and size of exposed faces, one 64-byte row each: centre, sharp,
/// normal, L (negative for quadrilaterals); and the rows of what does not move.
struct FaceGeometry {
  const Real* rows;
  const ExposedRow* table;

  /// Vertices of exposed faces.
  template <class Ids>
  CDEM_HD FaceVertices<Ids> vertices(const Ids& exposed) const {
    const auto at = [&](Index k) {
      return indices_of([&](Index x) { return table[x].corner[k]; }, exposed);
    };
    return {{at(0), at(1), at(2), at(3)}};
  }
  /// Characteristic area of a contact: a vertex's share of its face (Eq. 4-5), but not more than
  /// that of the face it meets; else a large face gives a small block a spring that no step can
  /// follow.
  CDEM_HD Real contact_area(Index m, Index t) const { return min_of(table[m].area, table[t].area); }
  /// Stiffness of the stiffer of two faces' elements  [Pa/m].
  CDEM_HD Real stiffer(Index m, Index t) const {
    return max_of(table[m].stiffness, table[t].stiffness);
  }
  template <class Ids>
  CDEM_HD auto center(const Ids& exposed) const {
    return InRows{rows}.at(exposed, 0).vector();
  }
  /// A row as a whole.
  template <class T>
  struct Face {
    Vec3<T> center, normal;
    T length;
  };
  template <class Ids>
  CDEM_HD auto row(const Ids& exposed) const {
    const auto first = InRows{rows}.at(exposed, 0), last = InRows{rows}.at(exposed, 4);
    return Face<Number<Ids>>{first.vector(), last.vector(), last.w};
  }
  /// Is side k an edge, or does the block's surface go on flat beyond it?
  CDEM_HD bool sharp(Index exposed, Index k) const {
    return Index(rows[std::size_t(exposed) * 8 + 3]) & (1 << k);
  }
  template <class Ids>
  CDEM_HD auto normal(const Ids& exposed) const {
    return InRows{rows}.at(exposed, 4).vector();
  }
  CDEM_HD Real length(Index exposed) const { return abs_of(rows[std::size_t(exposed) * 8 + 7]); }
  CDEM_HD bool is_triangle(Index exposed) const { return rows[std::size_t(exposed) * 8 + 7] > 0; }
};

/// Normal of the face across side k of an exposed face, from its row if it is exposed; 0 if there
/// is none.
CDEM_HD inline Vec3<Real> normal_across(const FaceColumns& faces, const FaceGeometry& geometry,
                                        Index exposed, Index k) {
  const Index beside = geometry.table[exposed].beside[k];
  if (beside >= 0) return geometry.normal(beside);
  const Index across = faces.across(exposed, k);
  return across >= 0 ? faces.shape(across).normal() : Vec3<Real>{0.0, 0.0, 0.0};
}
#if !defined(__CUDACC__)
inline Vec3<Pack> normal_across(const FaceColumns& faces, const FaceGeometry& geometry,
                                const IndexPack& exposed, const IndexPack& k) {
  Real hidden[lanes][4];  // of faces that have no row
  const Real* row[lanes];
  for (Index j = 0; j < lanes; ++j) {
    const Index beside = geometry.table[exposed.id[j]].beside[k.id[j]];
    row[j] = beside >= 0 ? geometry.rows + std::size_t(beside) * 8 + 4 : hidden[j];
    if (beside >= 0) continue;
    const Vec3<Real> n = normal_across(faces, geometry, exposed.id[j], k.id[j]);
    hidden[j][0] = n.x, hidden[j][1] = n.y, hidden[j][2] = n.z, hidden[j][3] = 0;
  }
  return load_rows([&](Index j) { return row[j]; });
}
#endif

/// Renew centre and normal of every exposed face.
struct UpdateFaceGeometry {
  FaceColumns faces;
  const Index* exposed_face;
  const ExposedRow* table;
  Real* rows;

  CDEM_HD void operator()(One i) const {
    const FaceShape<Real> f = faces.shape(FaceGeometry{rows, table}.vertices(i.i));
    const Vec3<Real> c = f.center(), n = f.normal();
    Real* r = rows + std::size_t(i.i) * 8;
    r[0] = c.x, r[1] = c.y, r[2] = c.z;
    r[4] = n.x, r[5] = n.y, r[6] = n.z;
    r[7] = (f.quad ? -1 : 1) * faces.face_length[exposed_face[i.i]];
  }
};

/// Faces of one block whose normals have a larger cosine than this (2.6 degrees) meet in no edge.
inline constexpr Real coplanar_faces = 0.999;

/// Renew which sides of every exposed face are sharp; runs after UpdateFaceGeometry.
struct MarkSharpSides {
  FaceColumns faces;
  const Flag* listed;  // [exposed] faces on no list need no marks; null: mark all
  const ExposedRow* table;
  Real* rows;

  CDEM_HD void operator()(One i) const {
    if (listed && !listed[i.i]) return;
    const FaceGeometry geometry{rows, table};
    int sharp = 0;
    for (Index k = 0; k < table[i.i].count(); ++k)
      if (faces.across(i.i, k) < 0 ||
          !(dot(geometry.normal(i.i), normal_across(faces, geometry, i.i, k)) > coplanar_faces))
        sharp |= 1 << k;
    rows[std::size_t(i.i) * 8 + 3] = Real(sharp);
  }
};

}  // namespace cdem
