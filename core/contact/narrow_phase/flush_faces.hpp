// flush_faces.hpp - parts of initially flush blocks that are hidden from third blocks.
#pragma once

#include "core/contact/geometry/edge.hpp"
#include "core/contact/geometry/face_geometry.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Blocks that lie flush have one surface for all others, as one mesh would have: no contact begins
/// at a face where the neighbour covers it, nor at an edge or a vertex in the seam unless it would
/// at the surface that both make. Faces that began flush are looked at, and count while they are:
/// no farther apart than an indentation, and as good as parallel.
struct FlushFaces {
  const Index* first;       // [face + 1]; null: no faces began flush
  const Index* mate;        // faces of other blocks, ascending in a row
  const Index* edge_faces;  // [edge][2] of one block, or -1

  /// Did two exposed faces begin with a corner at one place? Their blocks meet in the seams of
  /// others there, and neither hides the other.
  CDEM_HD static bool met(const FaceColumns& faces, const ExposedRow& a, const ExposedRow& b) {
    for (Index i = 0; i < 4; ++i)
      for (Index j = 0; j < 4; ++j)
        if (faces.node_place[a.corner[i]] == faces.node_place[b.corner[j]]) return true;
    return false;
  }

  /// Is face t covered where the indented point of a vertex lies over it, by a body that is not the
  /// vertex's own?
  CDEM_HD bool cover(const FaceColumns& faces, const SearchRules& rules, Index t,
                     const Vec3<Real>& point, Index node) const {
    return any_at(faces, rules, t, point, faces.body[node], [](const Seam&) { return true; });
  }

  /// Does a body that covers face f at a point, but the one of `spared`, lie where a contact normal
  /// leads from there? The point is a vertex or on an edge of f, and n points away from its block.
  /// Where the body ends and f goes on, it leaves room.
  CDEM_HD bool obstruct(const FaceColumns& faces, const SearchRules& rules, Index f,
                        const Vec3<Real>& point, const Vec3<Real>& n, Index spared) const {
    return any_at(faces, rules, f, point, faces.body[spared], [&](const Seam& seam) {
      if (!(dot(n, seam.normal) < -rules.cone)) return false;
      for (Index k = 0; k < seam.shape.count(); ++k)
        if (seam.ends_at(k) &&
            (dot(n, beyond(faces, seam.face, k)) > rules.cone || goes_on(faces, f, seam, k)))
          return false;
      return true;
    });
  }

  /// The face on which the surface goes on from an edge of face f, at a point on it: beyond the rim
  /// of the body that covers f there, but the one of `spared`; -1 where there is none.
  CDEM_HD Index beyond_cover(const FaceColumns& faces, const SearchRules& rules, Index f,
                             const Vec3<Real>& point, Index spared) const {
    Index found = -1;
    any_at(faces, rules, f, point, faces.body[spared], [&](const Seam& seam) {
      for (Index k = 0; k < seam.shape.count() && found < 0; ++k)
        if (seam.ends_at(k)) found = face_beyond(faces, seam.face, k);
      return found >= 0;
    });
    return found;
  }
  /// Does the surface turn up at an edge of face f, at a point on it: rises the face beyond the rim
  /// of the body that covers f there over `own`, the other face at the edge? Nothing meets the edge
  /// of such a corner but the faces beside it.
  CDEM_HD bool turns_up(const FaceColumns& faces, const SearchRules& rules, Index f, Index own,
                        const Vec3<Real>& point, const Vec3<Real>& along, Index spared) const {
    return any_at(faces, rules, f, point, faces.body[spared], [&](const Seam& seam) {
      for (Index k = 0; k < seam.shape.count(); ++k) {
        if (!seam.ends_at(k)) continue;
        const Index next = face_beyond(faces, seam.face, k);
        if (next < 0) continue;
        const Vec3<Real> to = faces.shape(next).center() - point;
        const Vec3<Real> out = to - (dot(to, along) / dot(along, along)) * along;
        if (dot(faces.shape(own).normal(), unit(out)) > rules.cone) return true;
      }
      return false;
    });
  }

 private:
  /// A face that covers a point.
  struct Seam {
    Index face;
    const FaceShape<Real>& shape;
    Vec3<Real> normal, point;
    Real room;  // within which lengths are the same  [m]

    CDEM_HD Vec3<Real> side(Index k) const {
      return shape.x[k + 1 == shape.count() ? 0 : k + 1] - shape.x[k];
    }
    /// Does the face end at side k where the point is?
    CDEM_HD bool ends_at(Index k) const {
      const Vec3<Real> along = side(k);
      const Real into = dot(cross(normal, along), point - shape.x[k]);
      return into < 0 || into * into <= room * room * dot(along, along);
    }
  };

  template <class Test>
  CDEM_HD bool any_at(const FaceColumns& faces, const SearchRules& rules, Index f,
                      const Vec3<Real>& point, Index spared, const Test& test) const {
    if (!first || first[f] == first[f + 1]) return false;
    const Vec3<Real> n = faces.shape(f).normal();
    for (Index r = first[f]; r < first[f + 1]; ++r) {
      const Index u = mate[r];
      if (faces.body[faces.vertex(u, 0)] == spared) continue;
      const FaceShape<Real> shape = faces.shape(u);
      const Real length = min_of(faces.face_length[f], faces.face_length[u]);
      const Seam seam{u, shape, shape.normal(), point, rules.tolerance * length};
      if (dot(n, seam.normal) < -coplanar_faces &&
          abs_of(dot(seam.normal, point - shape.center())) < rules.indentation * length &&
          shape.inside(point, seam.normal, seam.room) && test(seam))
        return true;
    }
    return false;
  }
  /// Does face f go on where the face that covers it ends at side k?
  CDEM_HD bool goes_on(const FaceColumns& faces, Index f, const Seam& seam, Index k) const {
    const Vec3<Real> out = unit(cross(seam.side(k), seam.normal));
    const FaceShape<Real> shape = faces.shape(f);
    return shape.inside(seam.point + Real(4.0) * seam.room * out, shape.normal(), seam.room);
  }
  /// The face across side k of a face of the same block, or -1.
  CDEM_HD Index face_beyond(const FaceColumns& faces, Index face, Index k) const {
    const Index exposed = faces.face_exposed[face];
    const Index* at = edge_faces + 2 * std::size_t(faces.face_edges[4 * face + k]);
    return exposed >= 0 ? faces.across(exposed, k) : at[at[0] == face];
  }
  /// Its normal; 0 where there is none.
  CDEM_HD Vec3<Real> beyond(const FaceColumns& faces, Index face, Index k) const {
    const Index across = face_beyond(faces, face, k);
    return across >= 0 ? faces.shape(across).normal() : Vec3<Real>{0.0, 0.0, 0.0};
  }
};

/// Sides of exposed faces, which are 4 * exposed face + side, in the seams of blocks that lie
/// flush.
struct HiddenEdges {
  FaceColumns faces;
  FaceGeometry geometry;
  SearchRules rules;
  FlushFaces flush;
  const Index* exposed_face;

  /// Is a contact of two sides inside the surface that one of their blocks makes with others that
  /// lie flush?
  CDEM_HD bool hide(Index mother, Index target) const {
    if (!flush.first || flush.met(faces, geometry.table[mother / 4], geometry.table[target / 4]))
      return false;
    const Index side[2] = {mother, target};
    Vec3<Real> x[2], along[2];
    for (Index e = 0; e < 2; ++e) {
      const ExposedRow& row = geometry.table[side[e] / 4];
      x[e] = faces.nodes.position(row.corner[side[e] % 4]);
      along[e] = faces.nodes.position(row.end(side[e] % 4)) - x[e];
    }
    const Vec3<Real> n =
        edge_normal(along[0], along[1], geometry.normal(target / 4) - geometry.normal(mother / 4));
    const Crossing<Real> at = cross_edges(x[0], along[0], x[1], along[1], n);
    const Vec3<Real> point[2] = {x[0] + at.s * along[0], x[1] + at.t * along[1]};
    for (Index e = 0; e < 2; ++e) {
      const Index exposed = side[e] / 4, k = side[e] % 4;
      const Index other = geometry.table[side[1 - e] / 4].corner[0];
      const Index at_edge[2] = {exposed_face[exposed], faces.across(exposed, k)};
      for (Index i = 0; i < 2; ++i) {
        const Index f = at_edge[i], own = at_edge[1 - i];
        if (f < 0) continue;
        if (flush.obstruct(faces, rules, f, point[e], e == 0 ? -n : n, other)) return true;
        if (own >= 0 && flush.turns_up(faces, rules, f, own, point[e], along[e], other))
          return true;
      }
    }
    return false;
  }
};

}  // namespace cdem
