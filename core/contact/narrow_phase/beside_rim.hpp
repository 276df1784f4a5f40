// beside_rim.hpp - contacts past a rim belong to the face beside it.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"

namespace cdem {

/// What comes past the rim of a face lies on the face beside it, where the way out of the block is
/// shorter. A contact that began with the face all the same would stop it.
struct BesideRim {
  FaceColumns faces;
  FaceGeometry geometry;

  /// Does a test hold for a face that bends away beside an exposed face, or beside the flat surface
  /// of which that is a part? It is given the face's centre and normal.
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
      return !are_flat(normal, own) && dot(own, center - at) < 0 && test(center, normal);
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

}  // namespace cdem
