// face.hpp - the shape of a face: frame, inside test, and the projection of a point.
#pragma once

#include "core/base/math.hpp"

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

}  // namespace cdem
