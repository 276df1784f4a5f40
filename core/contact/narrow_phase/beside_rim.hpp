// beside_rim.hpp - contacts past a rim belong to the face beside it.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"

namespace cdem {

/// What comes past the rim of a face lies on the face beside it, where the way out of the block is
/// shorter. A contact that began with the face all the same would stop it.
struct BesideRim {
  FaceColumns faces;
  FaceGeometry geometry;
  const Index* exposed_face;

  /// Does a test hold for a face that bends away beside an exposed face, or beside the flat surface
  /// of which that is a part? It is given the face's centre and normal.
  template <class Test>
  CDEM_HD bool any(Index exposed, const Test& test) const {
    if (any_at(exposed, exposed, test)) return true;
    for (Index k = 0; k < faces.vertex_count(exposed_face[exposed]); ++k) {
      const Index across = faces.across(exposed, k);
      const Index part = across < 0 ? -1 : faces.face_exposed[across];
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
    const Vec3<Real> own = geometry.normal(exposed);
    for (Index k = 0; k < faces.vertex_count(exposed_face[part]); ++k) {
      const Index across = faces.across(part, k);
      if (across < 0) continue;
      const FaceShape<Real> beside = faces.shape(across);
      const Vec3<Real> center = beside.center(), normal = beside.normal();
      if (!are_flat(normal, own) && dot(own, center - geometry.center(exposed)) < 0 &&
          test(center, normal))
        return true;
    }
    return false;
  }
};

}  // namespace cdem
