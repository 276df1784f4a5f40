// corotational.hpp - element forces from the total deformation: the default, and Eq. 1 as a
// baseline.
#pragma once

#include "core/elements/shapes.hpp"

namespace cdem {

/// Rotation of the element at a point from F = R U: the default.
struct FollowRotation {
  template <class T>
  CDEM_HD static Mat3<T> of(const Mat3<T>& f) {
    return polar_rotation(f);
  }
};

/// No rotation: F = K u, Feng et al. (2014), Eq. 1. A baseline; it cannot turn at all.
struct IgnoreRotation {
  template <class T>
  CDEM_HD static Mat3<T> of(const Mat3<T>&) {
    return identity<T>();
  }
};

/// Strain sym(R^T F) - I and rotation R at every Gauss point of one element.
template <class Shape, class Rotation, class T>
struct PointStrains {
  Mat3<T> rotation[Shape::points];
  Sym3<T> strain[Shape::points];

  template <class I>
  CDEM_HD PointStrains(const ElementColumns<Shape>& c, I e) {
    const Arms<Shape, T> arms = position_arms<Shape>(c, e);
    for (Index q = 0; q < Shape::points; ++q) {
      const Mat3<T> f = gradient_of<Shape>(c, e, q, arms);
      rotation[q] = Rotation::of(f);
      strain[q] = symmetric(transpose(rotation[q]) * f - identity<T>());
    }
    use_mean_dilatation<Shape>(c, e, strain);
  }
};

/// Element forces of the total corotational form.
///
/// With the strain E = sym(R^T F) - I and the law's stress S(E) in the unrotated frame, the force
/// on node k is -sum_q w J (R S) dN_k/dX. That is the exact derivative of the stored energy sum_q w
/// J W(E), because R is the closest rotation to F; so energy, linear and angular momentum are kept
/// to round-off whatever the rotation. (Written with the current B instead, the force is no
/// derivative of an energy: it differs by terms of the size of the strain.)
///
/// `damping_time` adds the stress of a Rayleigh dashpot, S(damping_time * rate of E) [s].
template <class Shape, class Rotation>
struct CorotationalForce {
  ElementColumns<Shape> columns;
  Real damping_time;        // [s]
  Real dt;                  // [s]
  InOutTable damping_work;  // [1][element]  [J], taken out by the dashpot so far
  OutForces corner_force;   // [N]

  static constexpr Fetching fetching{4, 4096};
  /// Not of hexahedra: with their 170 columns of gradients it costs more than it gains.
  CDEM_HD void fetch(One e) const
    requires(Shape::nodes == 4)
  {
    columns.fetch(e);
    corner_force.fetch(e, Shape::nodes);
  }

  template <class I>
  CDEM_HD void operator()(I e) const {
    forces(e).store(corner_force, e);
  }
  template <class I>
  CDEM_HD CornerForces<Shape, Number<I>> forces(I e) const {
    using T = Number<I>;
    const auto law = columns.material(e);
    PointStrains<Shape, Rotation, T> p(columns, e);
    CornerForces<Shape, T> force;
    for (Index q = 0; q < Shape::points; ++q) {
      const Sym3<T> stress = law.stress(p.strain[q]);
      force.add(columns, e, q, columns.point_volume.at(q, e) * (p.rotation[q] * full(stress)));
    }
    if constexpr (Shape::hourglass)
      Hourglass<T>(columns, e, position_arms<Shape>(columns, e)).add(columns, e, T(1.0), force);
    if (damping_time > 0) add_dashpot(e, law, p, force);
    return force;
  }

 private:
  template <class I, class Law, class T>
  CDEM_HD void add_dashpot(I e, const Law& law, const PointStrains<Shape, Rotation, T>& p,
                           CornerForces<Shape, T>& force) const {
    const Arms<Shape, T> arms = velocity_arms<Shape>(columns, e);
    Sym3<T> rate[Shape::points];
    for (Index q = 0; q < Shape::points; ++q) {
      const Mat3<T> turned = transpose(p.rotation[q]) * gradient_of<Shape>(columns, e, q, arms);
      // R^T (dF/dt) U^-1: the rate of deformation in the unrotated frame, objective up to strain^2
      rate[q] = symmetric(turned * (identity<T>() - full(p.strain[q])));
    }
    use_mean_dilatation<Shape>(columns, e, rate);
    T power(0.0);
    for (Index q = 0; q < Shape::points; ++q) {
      const T volume = columns.point_volume.at(q, e);
      const Sym3<T> stress = T(damping_time) * law.stress(rate[q]);
      force.add(columns, e, q, volume * (p.rotation[q] * full(stress)));
      power += volume * contract(stress, rate[q]);
    }
    if constexpr (Shape::hourglass) {
      const Hourglass<T> modes(columns, e, arms);
      modes.add(columns, e, T(damping_time), force);
      power += T(damping_time) * modes.stiffness * modes.square();
    }
    damping_work.set(0, e, damping_work.at(0, e) + T(dt) * power);
  }
};

/// Mean stress and stored energy of an element, for output and the energy ledger.
template <class Shape, class Rotation>
struct CorotationalReport {
  ElementColumns<Shape> columns;
  InOutTable stress;  // [6][element]  [Pa], Cauchy (to first order in the strain), global axes
  InOutTable energy;  // [1][element]  [J]

  template <class I>
  CDEM_HD void operator()(I e) const {
    using T = Number<I>;
    const auto law = columns.material(e);
    PointStrains<Shape, Rotation, T> p(columns, e);
    const T zero(0.0);
    Sym3<T> mean{zero, zero, zero, zero, zero, zero};
    T volume(0.0), stored(0.0);
    for (Index q = 0; q < Shape::points; ++q) {
      const T w = columns.point_volume.at(q, e);
      const Sym3<T> s = law.stress(p.strain[q]);
      const Mat3<T>& r = p.rotation[q];
      mean = mean + w * symmetric(r * full(s) * transpose(r));
      volume += w;
      stored += T(0.5) * w * contract(s, p.strain[q]);
    }
    if constexpr (Shape::hourglass) {
      const Hourglass<T> modes(columns, e, position_arms<Shape>(columns, e));
      stored += T(0.5) * modes.stiffness * modes.square();
    }
    energy.set(0, e, stored);
    const T scale = T(1.0) / volume;
    stress.set(0, e, scale * mean.xx);
    stress.set(1, e, scale * mean.yy);
    stress.set(2, e, scale * mean.zz);
    stress.set(3, e, scale * mean.xy);
    stress.set(4, e, scale * mean.yz);
    stress.set(5, e, scale * mean.zx);
  }
};

}  // namespace cdem
