// face_rotation.hpp - how a face turns, and nodal forces that are a couple on it.
#pragma once

#include "core/contact/geometry/face.hpp"

namespace cdem {

/// The rotation of a face: of its vertices about their mean, by least squares. It is exact for
/// a rigid rotation seen from the middle of a step.
struct FaceRotation {
  Vec3<Real> arm[4];  // vertices, from their mean  [m]
  Index count;
  Mat3<Real> inverse;  // of sum (r^2 1 - r r^T)  [1/m2]

  CDEM_HD static FaceRotation of(const FaceShape<Real>& shape) {
    FaceRotation f;
    f.count = shape.count();
    const Vec3<Real> center = shape.center();
    Mat3<Real> inertia = 0.0 * identity<Real>();
    for (Index j = 0; j < f.count; ++j) {
      f.arm[j] = shape.x[j] - center;
      inertia = inertia + dot(f.arm[j], f.arm[j]) * identity<Real>();
      add_outer(inertia, -f.arm[j], f.arm[j]);
    }
    f.inverse = cdem::inverse(inertia);
    return f;
  }
  /// Rotation by which the vertices moved so far.
  CDEM_HD Vec3<Real> turned(const Vec3<Real>* moved) const {
    Vec3<Real> sum{0.0, 0.0, 0.0};
    for (Index j = 0; j < count; ++j) sum = sum + cross(arm[j], moved[j]);
    return inverse * sum;
  }
  /// Force of a couple on a vertex: all sum to zero, and do the couple's work on the rotation.
  CDEM_HD Vec3<Real> force(Index j, const Vec3<Real>& couple) const {
    return cross(inverse * couple, arm[j]);
  }
  /// Square of the lever of a spring against rotation: one of K times this is no stiffer on the
  /// vertices than K (its largest eigenvalue is the stiffness over the least moment of inertia).
  /// [m2]
  CDEM_HD Real lever_squared() const {
    Real size = 0;  // Frobenius: not below the largest eigenvalue
    for (const Vec3<Real>& row : {inverse.r0, inverse.r1, inverse.r2}) size += dot(row, row);
    return 1 / sqrt_of(size);
  }
};

}  // namespace cdem
