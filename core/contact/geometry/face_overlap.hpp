// face_overlap.hpp - the area that two faces have in common.
#pragma once

#include "core/contact/geometry/face.hpp"

namespace cdem {

/// Two faces seen along the mean of their normals: the outline of the first is cut with the sides
/// of the second, and then where the planes of both lie too far apart, or too deep.
class FaceOverlap {
 public:
  CDEM_HD FaceOverlap(const FaceShape<Real>& a, const FaceShape<Real>& b) {
    const Vec3<Real> na = a.normal(), nb = b.normal(), n = unit(nb - na);
    const Frame<Real> frame = b.frame(n);
    const Vec3<Real> origin = b.center(), apart = a.center() - origin;
    count_ = a.count();
    for (Index k = 0; k < count_; ++k) {
      const Vec3<Real> arm = a.x[k] - origin;
      u_[k] = dot(frame.t1, arm), v_[k] = dot(frame.t2, arm);
    }
    const Real up_a = 1 / dot(na, n), up_b = 1 / dot(nb, n);
    gap_ = up_a * dot(na, apart);
    gap_u_ = up_b * dot(nb, frame.t1) - up_a * dot(na, frame.t1);
    gap_v_ = up_b * dot(nb, frame.t2) - up_a * dot(na, frame.t2);
    for (Index k = 0; k < b.count(); ++k) {
      const Vec3<Real> start = b.x[k] - origin, side = b.x[k + 1 == b.count() ? 0 : k + 1] - b.x[k];
      const Real su = dot(frame.t1, side), sv = dot(frame.t2, side);
      const Real from = sv * dot(frame.t1, start) - su * dot(frame.t2, start);
      keep(from, -sv, su);
    }
  }

  /// The part of it where the gap, which is negative inside, lies between two values [m]: m2, as
  /// seen along the mean of the normals.
  CDEM_HD Real area(Real deepest, Real farthest) {
    keep(farthest - gap_, -gap_u_, -gap_v_);
    keep(gap_ - deepest, gap_u_, gap_v_);
    Real twice = 0;
    for (Index k = 0; k < count_; ++k) {
      const Index next = k + 1 == count_ ? 0 : k + 1;
      twice += u_[k] * v_[next] - u_[next] * v_[k];
    }
    return 0.5 * abs_of(twice);
  }

 private:
  static constexpr Index most_corners = 4 + 4 + 2;
  Real u_[most_corners], v_[most_corners];
  Index count_;
  Real gap_, gap_u_, gap_v_;  // at a point: gap + gap_u u + gap_v v

  /// Cut off where at + at_u u + at_v v < 0.
  CDEM_HD void keep(Real at, Real at_u, Real at_v) {
    Real u[most_corners], v[most_corners];
    Index count = 0;
    for (Index k = 0; k < count_; ++k) {
      const Index next = k + 1 == count_ ? 0 : k + 1;
      const Real here = at + at_u * u_[k] + at_v * v_[k];
      const Real there = at + at_u * u_[next] + at_v * v_[next];
      if (here >= 0) u[count] = u_[k], v[count] = v_[k], ++count;
      if ((here >= 0) == (there >= 0) || count == most_corners) continue;
      const Real part = here / (here - there);
      u[count] = u_[k] + part * (u_[next] - u_[k]);
      v[count] = v_[k] + part * (v_[next] - v_[k]);
      ++count;
    }
    count_ = count;
    for (Index k = 0; k < count; ++k) u_[k] = u[k], v_[k] = v[k];
  }
};

}  // namespace cdem
