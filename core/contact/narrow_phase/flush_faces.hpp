// flush_faces.hpp - parts of initially flush blocks that are hidden from third blocks, and sharp
// rims.
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
  const Flag* at_node;      // has one of the faces at a node any?

  /// Have two exposed faces a corner where it began, at one place? Their blocks meet in the seams
  /// of others there, and neither hides the other.
  CDEM_HD static bool meet(const FaceColumns& faces, const SearchRules& rules, const ExposedRow& a,
                           const ExposedRow& b) {
    const Real room = rules.tolerance * min_of(a.reach, b.reach);
    for (Index i = 0; i < 4; ++i)
      for (Index j = 0; j < 4; ++j) {
        const Index p = a.corner[i], q = b.corner[j];
        if (faces.node_place[p] != faces.node_place[q]) continue;
        const Vec3<Real> apart = faces.nodes.position(p) - faces.nodes.position(q);
        if (dot(apart, apart) < room * room) return true;
      }
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
        if (dot(faces.shape(own).normal(), away(faces, next, point, along)) > rules.cone)
          return true;
      }
      return false;
    });
  }

  /// The direction in which a face leads away from a point on an edge of it.
  CDEM_HD static Vec3<Real> away(const FaceColumns& faces, Index face, const Vec3<Real>& point,
                                 const Vec3<Real>& along) {
    const Vec3<Real> to = faces.shape(face).center() - point;
    return unit(to - (dot(to, along) / dot(along, along)) * along);
  }
  /// The next of the faces of a block that meet at a node of theirs, and the side of this one
  /// between both.
  CDEM_HD Index next_around(const FaceColumns& faces, Index face, Index node, Index& side) const {
    for (side = 0; side < 3 && faces.vertex(face, side) != node;) ++side;
    const Index* at = edge_faces + 2 * std::size_t(faces.face_edges[4 * face + side]);
    return at[at[0] == face];
  }

 private:
  /// So wide a rim is at most: less than indented points lie inside of their own face.
  static constexpr Real most_of_indentation = 0.25;

  /// A face that covers a point.
  struct Seam {
    Index face;
    const FaceShape<Real>& shape;
    Vec3<Real> normal, point;
    Real room;  // within which lengths are the same, wider where it is open  [m]

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
      const Vec3<Real> normal = shape.normal();
      const Real apart = abs_of(dot(normal, point - shape.center()));
      const Real widest = most_of_indentation * rules.indentation * length;
      const Real room = max_of(rules.tolerance * length, min_of(apart, widest));
      const Seam seam{u, shape, normal, point, room};
      if (dot(n, normal) < -coplanar_faces && apart < rules.indentation * length &&
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

/// Pairs of sides of exposed faces, which are 4 * exposed face + side, that must not begin to
/// touch.
struct HiddenEdges {
  FaceColumns faces;
  FaceGeometry geometry;
  SearchRules rules;
  FlushFaces flush;
  const Index* exposed_face;

  /// Is a contact of two sides past a rim, or inside the surface that one of their blocks makes
  /// with others that lie flush?
  CDEM_HD bool hide(Index mother, Index target) const {
    const Crossed c = crossed(mother, target);
    return is_past_rim(c) || is_in_seam(c);
  }

 private:
  /// Two sides, where they cross.
  struct Crossed {
    Index side[2];
    Vec3<Real> along[2], point[2], n;
    Real part[2], gap;  // of either side from its start to the point; between the points  [m]
  };
  CDEM_HD Crossed crossed(Index mother, Index target) const {
    Crossed c{.side = {mother, target}, .along = {}, .point = {}, .n = {}, .part = {}, .gap = 0};
    Vec3<Real> x[2];
    for (Index e = 0; e < 2; ++e) {
      const ExposedRow& row = geometry.table[c.side[e] / 4];
      x[e] = faces.nodes.position(row.corner[c.side[e] % 4]);
      c.along[e] = faces.nodes.position(row.end(c.side[e] % 4)) - x[e];
    }
    c.n = edge_normal(c.along[0], c.along[1],
                      geometry.normal(target / 4) - geometry.normal(mother / 4));
    const Crossing<Real> at = cross_edges(x[0], c.along[0], x[1], c.along[1], c.n);
    c.part[0] = at.s, c.part[1] = at.t, c.gap = at.gap;
    for (Index e = 0; e < 2; ++e) c.point[e] = x[e] + c.part[e] * c.along[e];
    return c;
  }
  /// Does either edge ride on a face near an end of the other one?
  CDEM_HD bool is_past_rim(const Crossed& c) const {
    const Real length = min_of(geometry.length(c.side[0] / 4), geometry.length(c.side[1] / 4)),
               room = rules.tolerance * length, near = room + abs_of(c.gap) / rules.cone;
    for (Index e = 0; e < 2; ++e) {
      const Index other = 1 - e;
      const Real from_end = min_of(c.part[other], 1 - c.part[other]);
      const bool is_near =
          from_end < 0 || from_end * from_end * dot(c.along[other], c.along[other]) < near * near;
      if (is_near && rides(c.side[e], c.point[e], c.along[e], c.side[other], c.gap, room))
        return true;
    }
    return false;
  }
  CDEM_HD bool is_in_seam(const Crossed& c) const {
    const ExposedRow* const table = geometry.table;
    if (!flush.first || flush.meet(faces, rules, table[c.side[0] / 4], table[c.side[1] / 4]))
      return false;
    for (Index e = 0; e < 2; ++e) {
      const Index exposed = c.side[e] / 4, k = c.side[e] % 4;
      const Index other = table[c.side[1 - e] / 4].corner[0];
      const Index at_edge[2] = {exposed_face[exposed], faces.across(exposed, k)};
      for (Index i = 0; i < 2; ++i) {
        const Index f = at_edge[i], own = at_edge[1 - i];
        if (f < 0) continue;
        if (flush.obstruct(faces, rules, f, c.point[e], e == 0 ? -c.n : c.n, other)) return true;
        if (own >= 0 && flush.turns_up(faces, rules, f, own, c.point[e], c.along[e], other))
          return true;
      }
    }
    return false;
  }
  /// Does an edge touch, at a point, a face beside the other one, or pass it? There it is less
  /// deep, and no face of its own goes below.
  CDEM_HD bool rides(Index side, const Vec3<Real>& point, const Vec3<Real>& along, Index other,
                     Real gap, Real room) const {
    const auto above = [&](Index face, const Vec3<Real>& n) {
      return face < 0 || !(dot(n, FlushFaces::away(faces, face, point, along)) < -rules.cone);
    };
    const Index own[2] = {exposed_face[side / 4], faces.across(side / 4, side % 4)};
    const Index across = faces.across(other / 4, other % 4);
    const Index at_edge[2] = {other / 4, across < 0 ? -1 : faces.face_exposed[across]};
    const Vec3<Real> one = geometry.normal(other / 4),
                     two = normal_across(faces, geometry, other / 4, other % 4);
    const auto touches = [&](const Vec3<Real>& center, const Vec3<Real>& n) {
      return dot(n, point - center) > max_of(gap, -room) && !(dot(n, one) > coplanar_faces) &&
             !(dot(n, two) > coplanar_faces) && above(own[0], n) && above(own[1], n);
    };
    for (const Index exposed : at_edge)
      if (exposed >= 0 && BesideRim{faces, geometry}.any(exposed, touches)) return true;
    return false;
  }
};

}  // namespace cdem
