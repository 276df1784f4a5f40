// point_strains.hpp - rotation and strain at the Gauss points of an element.
#pragma once

#include "core/elements/shapes.hpp"

namespace cdem {

/// Rotation of the element at a point from F = R U: the default.
struct FollowRotation {
  template <class T>
  CDEM_HD static Mat3<T> of(const Mat3<T>& f) {
    return polar_rotation(f);
  }
  /// One more step, for large strain.
  template <class T>
  CDEM_HD static Mat3<T> nearer(const Mat3<T>& r) {
    return nearer_rotation(r);
  }
};

/// No rotation: F = K u, Feng et al. (2014), Eq. 1. A baseline; it cannot turn at all.
struct IgnoreRotation {
  template <class T>
  CDEM_HD static Mat3<T> of(const Mat3<T>&) {
    return identity<T>();
  }
  template <class T>
  CDEM_HD static Mat3<T> nearer(const Mat3<T>& r) {
    return r;
  }
};

/// Strain sym(R^T F) - I and rotation R at every Gauss point of one element.
template <class Shape, class Rotation, class T>
struct PointStrains {
  Mat3<T> rotation[Shape::points];
  Sym3<T> strain[Shape::points];
  T own_dilatation[Shape::points];  // trace of the strain before the element's mean took its place

  /// `flows`: may the element flow? Its strains may be large, so its rotation takes a step more.
  template <class I>
  CDEM_HD PointStrains(const ElementColumns<Shape>& c, I e, bool flows)
      : PointStrains(c, e, flows, position_arms<Shape>(c, e)) {}
  /// The same where the nodes are at these arms.
  template <class I>
  CDEM_HD PointStrains(const ElementColumns<Shape>& c, I e, bool flows,
                       const Arms<Shape, T>& arms) {
    for (Index q = 0; q < Shape::points; ++q) {
      const Mat3<T> f = gradient_of<Shape>(c, e, q, arms);
      rotation[q] = Rotation::of(f);
      if (flows) rotation[q] = Rotation::nearer(rotation[q]);
      strain[q] = symmetric(transpose(rotation[q]) * f - identity<T>());
      own_dilatation[q] = trace(strain[q]);
    }
    use_mean_dilatation<Shape>(c, e, strain);
  }
};

}  // namespace cdem
