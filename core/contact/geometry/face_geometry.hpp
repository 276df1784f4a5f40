// face_geometry.hpp - exterior faces and edges of all blocks; centre, normal and sharp sides of the
// exposed ones, renewed in every step.
#pragma once

#include "core/base/views.hpp"
#include "core/contact/geometry/face.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// Vertices of a face, or of one a lane; the fourth of a triangle repeats its third.
template <class Ids>
struct FaceVertices {
  Ids node[4];
  CDEM_HD auto quad() const { return differ(node[2], node[3]); }
};

/// The exterior faces and edges of all blocks: constant data, and the nodes' motion.
struct FaceColumns {
  InMotion nodes;
  const Index* face_nodes;       // [face][4], the fourth is -1 for a triangle
  const Index* face_edges;       // [face][4]: the edge from vertex k to k + 1
  const Real* face_length;       // L: mean distance from the centre to the vertices, Eq. 3  [m]
  const Real* face_height;       // of the element behind  [m]
  const Index* edge_nodes;       // [edge][2]
  const Index* beyond;           // [exposed][4]: face on the other side of side k, or -1
  const Index* edge_star_first;  // [label + 1]
  const Index* edge_star;        // other ends of the edges that leave a point
  const Index* bonded_node;      // label shared by nodes that intact bonds hold together
  const Index* body;             // label shared by nodes of all blocks that bonds join
  const Index* node_place;       // label shared by nodes that began at the same place
  const Index* face_exposed;     // [face]: place in the list of exposed faces, or -1
  Real dt;                       // [s]

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

/// Geometry of an exposed face, or one a lane.
template <class T>
struct FaceRow {
  Vec3<T> center, normal;
  T length;  // L, negative for quadrilaterals  [m]
};

/// Centre, sharp sides, normal and size of exposed faces, one 64-byte row each: centre, sharp,
/// normal, L (negative for quadrilaterals); and the rows of ExposedRow.
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
  /// the one of the face that it meets; else a large face gives a small block a spring that no step
  /// can follow.
  CDEM_HD Real contact_area(Index m, Index t) const { return min_of(table[m].area, table[t].area); }
  /// Stiffness of the element behind a face  [Pa/m].
  CDEM_HD Real stiffness(Index exposed) const { return table[exposed].stiffness; }
  template <class Ids>
  CDEM_HD auto center(const Ids& exposed) const {
    return InRows{rows}.at(exposed, 0).vector();
  }
  /// A row as a whole.
  template <class Ids>
  CDEM_HD auto row(const Ids& exposed) const {
    const auto first = InRows{rows}.at(exposed, 0), last = InRows{rows}.at(exposed, 4);
    return FaceRow<Number<Ids>>{first.vector(), last.vector(), last.w};
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
inline constexpr Real coplanar_faces = 0.999, coplanar_angle = 0.044725087168733454;  // [rad]

/// What comes past the rim of a face lies on the face beside it, where the way out of the block is
/// shorter. A contact that began with the face all the same would stop it.
struct BesideRim {
  FaceColumns faces;
  FaceGeometry geometry;

  /// Cosine between the normals at a rim. Over flatter ridges a vertex may go so deep before it is
  /// over the face beside it that no contact begins there.
  static constexpr Real sharp = 0.8;

  /// Does a test hold for a face that bends away at a rim of an exposed face, or of the flat
  /// surface of which that is a part? It is given the face's centre and normal.
  template <class Test>
  CDEM_HD bool any(Index exposed, const Test& test) const {
    if (any_at(exposed, exposed, test)) return true;
    const ExposedRow& row = geometry.table[exposed];
    for (Index k = 0; k < row.count(); ++k) {
      const Index part = row.beside[k];
      if (part >= 0 && are_flat(geometry.normal(part), geometry.normal(exposed)) &&
          any_at(part, exposed, test))
        return true;
    }
    return false;
  }

 private:
  CDEM_HD static bool are_flat(const Vec3<Real>& one, const Vec3<Real>& other) {
    return dot(one, other) > coplanar_faces;
  }
  template <class Test>
  CDEM_HD bool any_at(Index part, Index exposed, const Test& test) const {
    const Vec3<Real> own = geometry.normal(exposed), at = geometry.center(exposed);
    const auto bends = [&](const Vec3<Real>& center, const Vec3<Real>& normal) {
      return dot(normal, own) < sharp && dot(own, center - at) < 0 && test(center, normal);
    };
    const ExposedRow& row = geometry.table[part];
    for (Index k = 0; k < row.count(); ++k) {
      const Index beside = row.beside[k];
      if (beside >= 0 && bends(geometry.center(beside), geometry.normal(beside))) return true;
      const Index across = beside < 0 ? faces.across(part, k) : -1;
      if (across < 0) continue;
      const FaceShape<Real> shape = faces.shape(across);
      if (bends(shape.center(), shape.normal())) return true;
    }
    return false;
  }
};

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
