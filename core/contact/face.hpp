// face.hpp - exterior faces: their vertices, frame, inside test, and the projection of a point.
#pragma once

#include "core/field.hpp"

namespace cdem {

/// Orthonormal frame: normal n (of a face: outward), and t1, t2 in the plane.
template <class T>
struct Frame {
  Vec3<T> n, t1, t2;
};

/// A face at one instant. A triangle has count = 3; its fourth vertex repeats the third, so that
/// the normal is the cross product of the diagonals for both kinds.
struct FaceShape {
  Vec3<Real> x[4];
  Index count;

  CDEM_HD Vec3<Real> center() const {
    Vec3<Real> sum = x[0] + x[1] + x[2];
    if (count == 4) sum = sum + x[3];
    return Real(1.0) / Real(count) * sum;
  }
  CDEM_HD Vec3<Real> normal() const { return unit(cross(x[2] - x[0], x[3] - x[1])); }
  CDEM_HD Frame<Real> frame() const { return frame(normal()); }
  CDEM_HD Frame<Real> frame(const Vec3<Real>& n) const {
    const Vec3<Real> side = x[1] - x[0];
    const Vec3<Real> t1 = unit(side - dot(n, side) * n);
    return {n, t1, cross(n, t1)};
  }
  /// Is a point's projection inside, or outside by no more than `room` [m]? Eq. 7-8 with a length
  /// instead of a sign; most points are inside, which takes no root to see.
  CDEM_HD bool inside(const Vec3<Real>& point, const Vec3<Real>& n, Real room) const {
    for (Index k = 0; k < count; ++k) {
      const Vec3<Real> a = x[k], side = x[k + 1 == count ? 0 : k + 1] - a;
      const Real beyond = -dot(cross(n, side), point - a);  // times the length of the side
      if (beyond > 0 && beyond * beyond > room * room * dot(side, side)) return false;
    }
    return true;
  }
};

/// A point seen from a face: weights on the face's vertices and distance along the normal, so that
/// point = sum_j weight_j x_j + gap n.
struct Projection {
  Real weight[4];
  Real gap;
};

CDEM_HD inline Projection project_on_triangle(const FaceShape& f, const Vec3<Real>& point,
                                              const Vec3<Real>& n) {
  const Vec3<Real> a = f.x[1] - f.x[0], b = f.x[2] - f.x[0], p = point - f.x[0];
  const Real twice_area = dot(cross(a, b), n);
  const Real u = dot(cross(p, b), n) / twice_area;
  const Real v = dot(cross(a, p), n) / twice_area;
  return {{1.0 - u - v, u, v, 0.0}, dot(n, p)};
}

/// Newton on the bilinear surface, seen from its first vertex so that round-off does not grow with
/// the distance from the origin. A parallelogram takes one step, and one that shows it; the error
/// falls with the square of the step before, so a small step is the last.
CDEM_HD inline Projection project_on_quad(const FaceShape& f, const Vec3<Real>& point,
                                          const Vec3<Real>& n) {
  constexpr int most_steps = 20;
  constexpr Real last = 1e-8;
  const Vec3<Real> p = point - f.x[0], a = f.x[1] - f.x[0], b = f.x[3] - f.x[0];
  const Vec3<Real> warp = f.x[2] - f.x[3] - a;  // point at u, v: u a + v b + u v warp
  Real u = 0.5, v = 0.5;
  for (int step = 0; step < most_steps; ++step) {
    const Vec3<Real> along_u = a + v * warp, along_v = b + u * warp;
    const Vec3<Real> miss = p - u * along_u - v * b;
    const Real per_area = 1.0 / dot(cross(along_u, along_v), n);
    const Real du = dot(cross(miss, along_v), n) * per_area;
    const Real dv = dot(cross(along_u, miss), n) * per_area;
    u = u + du;
    v = v + dv;
    if (abs_of(du) + abs_of(dv) < last) break;
  }
  const Real gap = dot(n, p - u * (a + v * warp) - v * b);
  return {{(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v}, gap};
}

CDEM_HD inline Projection project(const FaceShape& f, const Vec3<Real>& point,
                                  const Vec3<Real>& n) {
  return f.count == 4 ? project_on_quad(f, point, n) : project_on_triangle(f, point, n);
}

/// The exterior faces and edges of all blocks: what never changes, and the nodes' motion.
struct FaceColumns {
  InMotion nodes;
  const Index* face_nodes;     // [face][4], the fourth is -1 for a triangle
  const Index* face_edges;     // [face][4]: the edge from vertex k to k + 1
  const Index* face_group;     // [face]
  const Real* face_length;     // L: mean distance from the centre to the vertices, Eq. 3  [m]
  const Real* face_reach;      // a little more than the farthest vertex from the centre  [m]
  const Real* face_area;       // [m2]
  const Real* face_height;     // of the element behind  [m]
  const Real* face_stiffness;  // modulus of the element behind over its height  [Pa/m]
  const Index* edge_nodes;     // [edge][2]
  const Index* beyond;         // [exposed][4]: face on the other side of side k, or -1
  const Index* ring_first;     // [label + 1]
  const Index* ring;           // other ends of the edges that leave a point
  const Index* node_glue;      // label shared by nodes that intact bonds hold together
  const Index* node_place;     // label shared by nodes that began at the same place
  const Index* face_exposed;   // [face]: place in the list of exposed faces, or -1
  Real dt;                     // [s]

  CDEM_HD Index vertex_count(Index face) const { return face_nodes[4 * face + 3] < 0 ? 3 : 4; }
  CDEM_HD Index vertex(Index face, Index k) const { return face_nodes[4 * face + k]; }

  /// Which side of a face an edge of its own is.
  CDEM_HD Index side_on(Index face, Index edge) const {
    for (Index k = 0; k < 3; ++k)
      if (face_edges[4 * face + k] == edge) return k;
    return 3;
  }
  /// Characteristic area of a contact: a vertex's share of its face (Eq. 4-5), but not more than
  /// that of the face it meets; else a large face gives a small block a spring that no step can
  /// follow.
  CDEM_HD Real contact_area(Index face_m, Index face_t) const {
    return min_of(face_area[face_m] / Real(vertex_count(face_m)),
                  face_area[face_t] / Real(vertex_count(face_t)));
  }
  CDEM_HD FaceShape shape(Index face) const {
    FaceShape f;
    f.count = vertex_count(face);
    for (Index k = 0; k < f.count; ++k) f.x[k] = nodes.position(vertex(face, k));
    if (f.count == 3) f.x[3] = f.x[2];
    return f;
  }
  /// The face on the other side of side k of an exposed face, or -1: of the same block or of one
  /// that is bonded to it there.
  CDEM_HD Index across(Index exposed, Index k) const { return beyond[4 * exposed + k]; }
  /// Where a node was one step ago.
  CDEM_HD Vec3<Real> old_position(Index node) const {
    return nodes.position(node) - dt * nodes.velocity(node);
  }
  CDEM_HD FaceShape old_shape(Index face) const {
    FaceShape f;
    f.count = vertex_count(face);
    for (Index k = 0; k < f.count; ++k) f.x[k] = old_position(vertex(face, k));
    if (f.count == 3) f.x[3] = f.x[2];
    return f;
  }
};

/// Centre, sharp sides, normal and size of exposed faces, one 64-byte row each: centre, sharp,
/// normal, L (negative for quadrilaterals).
struct FaceGeometry {
  const Real* rows;
  CDEM_HD Vec3<Real> center(Index exposed) const {
    const Real* r = rows + std::size_t(exposed) * 8;
    return {r[0], r[1], r[2]};
  }
  /// Is side k an edge, or does the block's surface go on flat beyond it?
  CDEM_HD bool sharp(Index exposed, Index k) const {
    return Index(rows[std::size_t(exposed) * 8 + 3]) & (1 << k);
  }
  CDEM_HD Vec3<Real> normal(Index exposed) const {
    const Real* r = rows + std::size_t(exposed) * 8 + 4;
    return {r[0], r[1], r[2]};
  }
  CDEM_HD Real length(Index exposed) const { return abs_of(rows[std::size_t(exposed) * 8 + 7]); }
  CDEM_HD bool is_triangle(Index exposed) const { return rows[std::size_t(exposed) * 8 + 7] > 0; }
};

/// Normal of any face, from its row if it is exposed.
CDEM_HD inline Vec3<Real> normal_of(const FaceColumns& faces, const FaceGeometry& geometry,
                                    Index face) {
  const Index exposed = faces.face_exposed[face];
  return exposed >= 0 ? geometry.normal(exposed) : faces.shape(face).normal();
}

/// Renew centre and normal of every exposed face.
struct UpdateFaceGeometry {
  FaceColumns faces;
  const Index* exposed_face;
  Real* rows;

  CDEM_HD void operator()(One i) const {
    const FaceShape f = faces.shape(exposed_face[i.i]);
    const Vec3<Real> c = f.center(), n = f.normal();
    Real* r = rows + std::size_t(i.i) * 8;
    r[0] = c.x, r[1] = c.y, r[2] = c.z;
    r[4] = n.x, r[5] = n.y, r[6] = n.z;
    r[7] = (f.count == 3 ? 1 : -1) * faces.face_length[exposed_face[i.i]];
  }
};

/// Faces of one block whose normals have a larger cosine than this (2.6 degrees) meet in no edge.
inline constexpr Real coplanar_faces = 0.999;

/// Renew which sides of every exposed face are sharp; runs after UpdateFaceGeometry.
struct MarkSharpSides {
  FaceColumns faces;
  const Index* exposed_face;
  // faces whose sides nobody may cross need no marks; null: mark all
  const Index *edge_candidate_first, *source_first;
  Real* rows;

  CDEM_HD void operator()(One i) const {
    if (source_first && source_first[i.i] == source_first[i.i + 1] &&
        edge_candidate_first[i.i] == edge_candidate_first[i.i + 1])
      return;
    const FaceGeometry geometry{rows};
    const Index face = exposed_face[i.i];
    int sharp = 0;
    for (Index k = 0; k < faces.vertex_count(face); ++k) {
      const Index across = faces.across(i.i, k);
      if (across < 0 ||
          !(dot(geometry.normal(i.i), normal_of(faces, geometry, across)) > coplanar_faces))
        sharp |= 1 << k;
    }
    rows[std::size_t(i.i) * 8 + 3] = Real(sharp);
  }
};

}  // namespace cdem
