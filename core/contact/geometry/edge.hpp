// edge.hpp - two edges: where they cross, their normal and their frame. Feng et al. (2014), Eq. 12.
#pragma once

#include "core/contact/geometry/face.hpp"

namespace cdem {

/// Where x_m + s d_m and x_t + t d_t are closest along a direction: x_m(s) - x_t(t) = gap *
/// direction.
template <class T>
struct Crossing {
  T s, t, gap;
};

template <class T>
CDEM_HD inline Crossing<T> cross_edges(const Vec3<T>& start_m, const Vec3<T>& along_m,
                                       const Vec3<T>& start_t, const Vec3<T>& along_t,
                                       const Vec3<T>& direction) {
  const Vec3<T> apart = start_t - start_m;
  const Vec3<T> c = cross(along_m, along_t);
  const T det = dot(c, direction);
  return {dot(cross(apart, along_t), direction) / det, dot(cross(apart, along_m), direction) / det,
          -dot(c, apart) / det};
}

/// Normal of an edge pair, V_mm x V_tt of Eq. 12, on the side of `out`. Any other, e.g. the normal
/// of faces that are nearly flush, makes or loses energy: only along the common perpendicular is
/// the gap's rate the velocity of the two points of the crossing.
template <class T>
CDEM_HD inline Vec3<T> edge_normal(const Vec3<T>& along_m, const Vec3<T>& along_t,
                                   const Vec3<T>& out) {
  const Vec3<T> c = unit(cross(along_m, along_t));
  return select(dot(c, out) < T(0.0), -c, c);
}

/// Tangents of an edge pair: along the target edge, and across.
template <class T>
CDEM_HD inline Frame<T> edge_frame(const Vec3<T>& n, const Vec3<T>& along_t) {
  const Vec3<T> t1 = unit(along_t - dot(n, along_t) * n);
  return {n, t1, cross(n, t1)};
}

}  // namespace cdem
