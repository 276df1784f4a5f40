// shapes.hpp - the four element shapes, and how an element reads its nodes and writes its forces.
#pragma once

#include "core/base/parallel.hpp"
#include "core/base/views.hpp"
#include "core/materials/material_table.hpp"

namespace cdem {

/// One Gauss point: the strain is constant.
struct Tet4 {
  static constexpr Index nodes = 4, points = 1;
  static constexpr Index per_cell = 6;  // so many of a Box's elements make a cell of it
  static constexpr bool mean_dilatation = false, hourglass = false;
};
/// Rational shape functions, five Gauss points.
struct Pyramid5 {
  static constexpr Index nodes = 5, points = 5;
  static constexpr Index per_cell = 6;
  static constexpr bool mean_dilatation = false, hourglass = false;
};
/// Six Gauss points: three in the triangle times two.
struct Wedge6 {
  static constexpr Index nodes = 6, points = 6;
  static constexpr Index per_cell = 2;
  static constexpr bool mean_dilatation = false, hourglass = false;
};
/// 2 x 2 x 2 Gauss points; the volumetric strain is the element's mean (B-bar), so that nearly
/// incompressible rock does not lock.
struct Hex8 {
  static constexpr Index nodes = 8, points = 8;
  static constexpr Index per_cell = 1;
  static constexpr bool mean_dilatation = true, hourglass = false;
};
/// One point with the mean gradients, and springs against the four ways to deform that have no mean
/// strain (hourglass modes).
struct Hex8OnePoint {
  static constexpr Index nodes = 8, points = 1;
  static constexpr Index per_cell = 1;
  static constexpr bool mean_dilatation = false, hourglass = true;
};

/// Input of every element kernel: nodes, reference gradients, volumes, material.
///
/// The gradients dN/dX [1/m] belong to the stress-free mesh; node 0 is left out, because the
/// gradients of an element sum to zero.
template <class Shape>
struct ElementColumns {
  InMotion nodes;
  InIndices element_nodes;     // [Shape::nodes][element]
  InTable gradient;            // [point * (nodes-1)*3 + (node-1)*3 + axis][element]  [1/m]
  InTable point_volume;        // w J: [point][element]  [m3]
  InIndices element_material;  // [1][element]
  MaterialTable materials;
  InTable hourglass;  // one-point: [4 * 3] moments of the modes [m], and their stiffness [N/m]

  template <class I>
  CDEM_HD Vec3<Number<I>> gradient_at(I e, Index point, Index node) const {
    const Index row = (point * (Shape::nodes - 1) + node - 1) * 3;
    return {gradient.at(row, e), gradient.at(row + 1, e), gradient.at(row + 2, e)};
  }
  /// Ask for the columns of a block, with its first element.
  CDEM_HD void fetch(One e) const {
    if (e.i % block_size != 0) return;
    for (Index k = 0; k < Shape::nodes; ++k) element_nodes.fetch(k, e);
    point_volume.fetch(0, e);
    for (Index row = 0; row < Shape::points * (Shape::nodes - 1) * 3; ++row) gradient.fetch(row, e);
  }
  template <class I>
  CDEM_HD ElasticConstants<Number<I>> elastic(I e) const {
    return materials.elastic(element_material.at(0, e));
  }
};

/// Positions (or velocities) of nodes 1.. of an element, relative to node 0.
template <class Shape, class T>
struct Arms {
  Vec3<T> a[Shape::nodes];

  CDEM_HD const Vec3<T>& operator[](Index node) const { return a[node]; }
};

template <class Shape, class I>
CDEM_HD inline Arms<Shape, Number<I>> position_arms(const ElementColumns<Shape>& c, I e) {
  Arms<Shape, Number<I>> arms;
  const Vec3<Number<I>> x0 = c.nodes.position(c.element_nodes.at(0, e));
  for (Index k = 1; k < Shape::nodes; ++k)
    arms.a[k] = c.nodes.position(c.element_nodes.at(k, e)) - x0;
  return arms;
}
template <class Shape, class I>
CDEM_HD inline Arms<Shape, Number<I>> velocity_arms(const ElementColumns<Shape>& c, I e) {
  Arms<Shape, Number<I>> arms;
  const Vec3<Number<I>> v0 = c.nodes.velocity(c.element_nodes.at(0, e));
  for (Index k = 1; k < Shape::nodes; ++k)
    arms.a[k] = c.nodes.velocity(c.element_nodes.at(k, e)) - v0;
  return arms;
}

/// sum_k a_k (dN_k/dX)^T: the deformation gradient for positions, its rate for velocities.
template <class Shape, class I>
CDEM_HD inline Mat3<Number<I>> gradient_of(const ElementColumns<Shape>& c, I e, Index point,
                                           const Arms<Shape, Number<I>>& arms) {
  const Number<I> zero(0.0);
  const Vec3<Number<I>> none{zero, zero, zero};
  Mat3<Number<I>> sum{none, none, none};
  for (Index k = 1; k < Shape::nodes; ++k) add_outer(sum, arms[k], c.gradient_at(e, point, k));
  return sum;
}

/// Forces that the element exerts on its nodes, summed over Gauss points.
template <class Shape, class T>
struct CornerForces {
  Vec3<T> f[Shape::nodes];

  CDEM_HD CornerForces() {
    const T zero(0.0);
    for (Index k = 0; k < Shape::nodes; ++k) f[k] = {zero, zero, zero};
  }
  /// Add -P dN_k/dX of one point; P is the first Piola-Kirchhoff stress times the point's volume.
  template <class I>
  CDEM_HD void add(const ElementColumns<Shape>& c, I e, Index point, const Mat3<T>& p) {
    for (Index k = 1; k < Shape::nodes; ++k) {
      const Vec3<T> fk = p * c.gradient_at(e, point, k);
      f[k] = f[k] - fk;
      f[0] = f[0] + fk;  // the gradients sum to zero, so the forces do too, exactly
    }
  }
  template <class I>
  CDEM_HD void store(OutForces out, I e) const {
    for (Index k = 0; k < Shape::nodes; ++k) out.set(e, Shape::nodes, k, f[k]);
  }
};

/// Amplitudes of the hourglass modes and their resistance: Flanagan & Belytschko (1981), total.
///
/// Mode a has the pattern G_ak = rs, st, tr, rst at node k. Its amplitude is what the positions
/// hold of the pattern beyond their linear part, q_a = sum_k G_ak x_k - F sum_k G_ak X_k, so it is
/// zero for any rigid motion and any constant strain, without asking for the rotation. The energy
/// is k/2 sum |q_a|^2; with k = E V^(1/3) / 48 a cube bends like a beam.
template <class T>
struct Hourglass {
  Vec3<T> moment[4], amplitude[4];
  T stiffness;

  template <class I>
  CDEM_HD Hourglass(const ElementColumns<Hex8OnePoint>& c, I e, const Arms<Hex8OnePoint, T>& arms)
      : stiffness(c.hourglass.at(12, e)) {
    const Mat3<T> f = gradient_of<Hex8OnePoint>(c, e, 0, arms);
    for (Index a = 0; a < 4; ++a) {
      moment[a] = {c.hourglass.at(3 * a, e), c.hourglass.at(3 * a + 1, e),
                   c.hourglass.at(3 * a + 2, e)};
      amplitude[a] = T(-1.0) * (f * moment[a]);
      for (Index k = 1; k < 8; ++k) amplitude[a] = amplitude[a] + T(pattern(a, k)) * arms[k];
    }
  }
  /// q . q summed over the modes.
  CDEM_HD T square() const {
    T sum(0.0);
    for (Index a = 0; a < 4; ++a) sum += dot(amplitude[a], amplitude[a]);
    return sum;
  }
  /// Add `scale` times the springs' forces to the forces of the corners.
  template <class I>
  CDEM_HD void add(const ElementColumns<Hex8OnePoint>& c, I e, const T& scale,
                   CornerForces<Hex8OnePoint, T>& force) const {
    for (Index k = 1; k < 8; ++k) {
      const Vec3<T> gradient = c.gradient_at(e, 0, k);
      for (Index a = 0; a < 4; ++a) {
        const T share = T(pattern(a, k)) - dot(moment[a], gradient);
        const Vec3<T> fk = (scale * stiffness * share) * amplitude[a];
        force.f[k] = force.f[k] - fk;
        force.f[0] = force.f[0] + fk;  // shares sum to zero
      }
    }
  }

 private:
  CDEM_HD static constexpr Real pattern(Index mode, Index node) {
    const Real r = ((node + 1) & 2) ? 1 : -1, s = (node & 2) ? 1 : -1, t = (node & 4) ? 1 : -1;
    return mode == 0 ? r * s : mode == 1 ? s * t : mode == 2 ? t * r : r * s * t;
  }
};

/// Replace the volumetric part of each point's strain by the element's mean (B-bar).
template <class Shape, class I>
CDEM_HD inline void use_mean_dilatation(const ElementColumns<Shape>& c, I e,
                                        Sym3<Number<I>>* strain) {
  if constexpr (Shape::mean_dilatation) {
    Number<I> sum(0.0), volume(0.0);
    for (Index q = 0; q < Shape::points; ++q) {
      const Number<I> w = c.point_volume.at(q, e);
      sum += w * trace(strain[q]);
      volume += w;
    }
    const Number<I> mean = sum / volume;
    for (Index q = 0; q < Shape::points; ++q) strain[q] = with_trace(strain[q], mean);
  }
}

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
