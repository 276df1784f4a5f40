// incremental.hpp - element forces from the step's displacement increment, Eq. 2, in two forms.
#pragma once

#include "core/elements/shapes.hpp"

namespace cdem {

/// Deformation of a point in one step: strain increment, spin, and the configuration it is taken
/// in.
template <class T>
struct Increment {
  Sym3<T> strain;  // sym(dL)
  Mat3<T> spin;    // skew(dL)
};

/// dL = (dF) F^-1, split into strain and spin; F belongs to the configuration of B.
template <class T>
CDEM_HD inline Increment<T> increment_of(const Mat3<T>& delta_f, const Mat3<T>& f) {
  const Mat3<T> l = delta_f * inverse(f);
  return {symmetric(l), T(0.5) * (l - transpose(l))};
}

/// Default of the option `incremental`: B of the midpoint, the stress turned by half the rotation
/// before and half after D de. Turned whole first and then added to (the textbook Hughes-Winget
/// form), an undamped spinning block blows up within 100 revolutions; turned by halves it does not.
struct TurnByHalves {
  template <class T>
  CDEM_HD static Mat3<T> configuration(const Mat3<T>& f_old, const Mat3<T>& f_new) {
    return T(0.5) * (f_old + f_new);
  }
  template <class T>
  CDEM_HD static Sym3<T> update(const Sym3<T>& stress, const Increment<T>& d, const Sym3<T>& strain,
                                const ElasticConstants<T>& elastic) {
    // half of the rotation, by Cayley: (I - W/4)^-1 (I + W/4)
    const Mat3<T> one = identity<T>(), quarter = T(0.5) * (T(0.5) * d.spin);
    const Mat3<T> half_turn = inverse(one - quarter) * (one + quarter);
    const Mat3<T> back = transpose(half_turn);
    const Sym3<T> turned = symmetric(half_turn * full(stress) * back);
    const Sym3<T> loaded = turned + elastic.stress(strain);
    return symmetric(half_turn * full(loaded) * back);
  }
};

/// [paper] Eq. 2 as printed: B renewed at the end of the step, the stress not turned. Its volume
/// drifts by 2 pi times the rotation of a step per revolution.
struct NeverTurn {
  template <class T>
  CDEM_HD static Mat3<T> configuration(const Mat3<T>&, const Mat3<T>& f_new) {
    return f_new;
  }
  template <class T>
  CDEM_HD static Sym3<T> update(const Sym3<T>& stress, const Increment<T>&, const Sym3<T>& strain,
                                const ElasticConstants<T>& elastic) {
    return stress + elastic.stress(strain);
  }
};

/// Element forces of the incremental form, Feng et al. (2014), Eq. 2; stress is the state.
template <class OfShape, class Turning>
struct IncrementalForce {
  using Shape = OfShape;
  ElementColumns<Shape> columns;
  Real dt;            // [s]
  InOutTable stress;  // Cauchy, [point * 6 + component][element]  [Pa]
  InOutTable energy;  // [1][element]  [J], work done on the element so far

  /// Forces on the corners of an element  [N].
  template <class I>
  CDEM_HD CornerForces<Shape, Number<I>> forces(I e) const {
    using T = Number<I>;
    const auto elastic = columns.elastic(e);
    const Arms<Shape, T> arms = position_arms<Shape>(columns, e);
    const Arms<Shape, T> velocities = velocity_arms<Shape>(columns, e);
    Increment<T> increment[Shape::points];
    Sym3<T> strain[Shape::points];
    Mat3<T> f_new[Shape::points];
    for (Index q = 0; q < Shape::points; ++q) {
      f_new[q] = gradient_of<Shape>(columns, e, q, arms);
      const Mat3<T> delta_f = T(dt) * gradient_of<Shape>(columns, e, q, velocities);
      increment[q] = increment_of(delta_f, Turning::configuration(f_new[q] - delta_f, f_new[q]));
      strain[q] = increment[q].strain;
    }
    use_mean_dilatation<Shape>(columns, e, strain);

    CornerForces<Shape, T> force;
    T work(0.0);
    for (Index q = 0; q < Shape::points; ++q) {
      const Sym3<T> before = stress_at(e, q);
      const Sym3<T> after = Turning::update(before, increment[q], strain[q], elastic);
      keep_stress(e, q, after);
      const T volume = columns.point_volume.at(q, e);
      const T current = determinant(f_new[q]) * volume;
      work += T(0.5) * current * contract(before + after, strain[q]);
      // Cauchy stress to first Piola-Kirchhoff: P = det(F) sigma F^-T
      force.add(columns, e, q, volume * (full(after) * cofactor(f_new[q])));
    }
    if constexpr (Shape::hourglass) {
      const Hourglass<T> modes(columns, e, arms), rates(columns, e, velocities);
      modes.add(columns, e, T(1.0), force);
      T power(0.0);  // of the mean amplitude in the step
      for (Index a = 0; a < 4; ++a)
        power += dot(modes.amplitude[a] - T(0.5 * dt) * rates.amplitude[a], rates.amplitude[a]);
      work += T(dt) * modes.stiffness * power;
    }
    energy.set(0, e, energy.at(0, e) + work);
    return force;
  }

 private:
  template <class I>
  CDEM_HD Sym3<Number<I>> stress_at(I e, Index q) const {
    return {stress.at(6 * q, e),     stress.at(6 * q + 1, e), stress.at(6 * q + 2, e),
            stress.at(6 * q + 3, e), stress.at(6 * q + 4, e), stress.at(6 * q + 5, e)};
  }
  template <class I>
  CDEM_HD void keep_stress(I e, Index q, const Sym3<Number<I>>& s) const {
    stress.set(6 * q, e, s.xx);
    stress.set(6 * q + 1, e, s.yy);
    stress.set(6 * q + 2, e, s.zz);
    stress.set(6 * q + 3, e, s.xy);
    stress.set(6 * q + 4, e, s.yz);
    stress.set(6 * q + 5, e, s.zx);
  }
};

}  // namespace cdem
