// principal_planes.hpp - the exact return to the planes that Mohr-Coulomb with a tension cut-off
// has in principal stress.
#pragma once

#include "core/base/math.hpp"

namespace cdem {

/// Plastic strain in the principal directions, the largest stress first.
template <class T>
struct PrincipalFlow {
  T strain[3];
  T shear;    // sqrt(2/3 s:s), s the deviator of plastic strain on the planes of shear
  T tension;  // plastic strain on the planes of tension
};

/// The same as a tensor.
template <class T>
CDEM_HD inline Sym3<T> tensor_of(const PrincipalFlow<T>& flow, const PrincipalAxes<T>& p) {
  const T none(0.0);
  Mat3<T> strain{{none, none, none}, {none, none, none}, {none, none, none}};
  for (Index k = 0; k < 3; ++k) add_outer(strain, flow.strain[k] * p.axis[k], p.axis[k]);
  return symmetric(strain);
}

/// sqrt(N), N = (1 + sin) / (1 - sin), from the tangent of an angle.
template <class T>
CDEM_HD inline T root_of_n(const T& tangent) {
  return tangent + sqrt_of(T(1.0) + tangent * tangent);
}

/// Planes of yield in principal stress s1 >= s2 >= s3, tension positive: shear s_i - s_j / N =
/// strength for the pairs 13, 23 and 12, and tension s_i = cut for 1, 2 and 3. Flow is along
/// (1, -1/M) on planes of shear and along the normal on planes of tension.
///
/// `cut` must not lie beyond the apex of the shear planes: else points past it come back unsorted.
template <class T>
struct PrincipalPlanes {
  T slope, flow_slope;  // 1/N, 1/M
  T strength;           // [Pa]
  T cut;                // [Pa]

  /// How far a stress lies outside; below 0 inside  [Pa].
  CDEM_HD T outside(const Vec3<T>& s) const {
    const T shear = max_of(s.x, s.y) - strength - slope * s.z;  // 13 or 23
    return max_of(max_of(shear, s.x - slope * s.y - strength), max_of(max_of(s.x, s.y), s.z) - cut);
  }

  /// Flow that brings a stress back. The active planes are the first of ten sets whose multipliers
  /// are not negative and which leaves no plane outside; within the tolerance, or else the best.
  /// All ten are computed, the later ones first.
  CDEM_HD PrincipalFlow<T> bring_back(const T& lambda, const T& mu, const Vec3<T>& trial,
                                      const T& tolerance) const {
    Choice choice{.fault = T(1e300), .multiplier = {}};
    for (T& one : choice.multiplier) one = T(0.0);
    const Return back{*this, lambda / mu, trial, tolerance};
    back.template attempt<s13, s23, t1>(choice);
    back.template attempt<s13, t1, t2>(choice);
    back.template attempt<s13, s12, t1>(choice);
    back.template attempt<s13, t1>(choice);
    back.template attempt<t1, t2, t3>(choice);
    back.template attempt<t1, t2>(choice);
    back.template attempt<t1>(choice);
    back.template attempt<s13, s12>(choice);
    back.template attempt<s13, s23>(choice);
    back.template attempt<s13>(choice);
    return flow_of(choice, T(1.0) / mu);
  }

 private:
  enum Plane { s13, s23, s12, t1, t2, t3 };

  struct Choice {
    T fault;          // how far the answer is from right  [Pa]
    T multiplier[6];  // of the planes, times mu  [Pa]
  };

  CDEM_HD Vec3<T> across(Plane plane, const T& k) const {
    const T none(0.0), one(1.0);
    switch (plane) {
      case s13:
        return {one, none, -k};
      case s23:
        return {none, one, -k};
      case s12:
        return {one, -k, none};
      default:
        return {T(plane == t1), T(plane == t2), T(plane == t3)};
    }
  }
  CDEM_HD Vec3<T> normal(Plane plane) const { return across(plane, slope); }
  CDEM_HD Vec3<T> flow(Plane plane) const { return across(plane, flow_slope); }
  CDEM_HD T limit(Plane plane) const { return plane < t1 ? strength : cut; }

  struct Return {
    const PrincipalPlanes& planes;
    T lambda;  // over mu
    const Vec3<T>& trial;
    const T& tolerance;

    /// Stress of a strain in the principal directions, over mu.
    CDEM_HD Vec3<T> stress(const Vec3<T>& strain) const {
      const T pressure = lambda * (strain.x + strain.y + strain.z);
      return {pressure + strain.x + strain.x, pressure + strain.y + strain.y,
              pressure + strain.z + strain.z};
    }
    /// Row of the system that makes a plane's excess vanish.
    template <Plane... active>
    CDEM_HD Vec3<T> row(Plane plane) const {
      T numbers[3] = {T(0.0), T(0.0), T(0.0)};
      Index place = 0;
      ((numbers[place++] = dot(planes.normal(plane), stress(planes.flow(active)))), ...);
      return {numbers[0], numbers[1], numbers[2]};
    }
    template <Plane... active>
    CDEM_HD void attempt(Choice& choice) const {
      constexpr Index count = sizeof...(active);
      constexpr Plane plane[] = {active...};
      Mat3<T> system = identity<T>();
      Vec3<T> excess{T(0.0), T(0.0), T(0.0)};
      const auto over = [&](Plane p) { return dot(planes.normal(p), trial) - planes.limit(p); };
      system.r0 = row<active...>(plane[0]), excess.x = over(plane[0]);
      if constexpr (count > 1) system.r1 = row<active...>(plane[1]), excess.y = over(plane[1]);
      if constexpr (count > 2) system.r2 = row<active...>(plane[2]), excess.z = over(plane[2]);
      const Mat3<T> inverted = inverse(system);
      const Vec3<T> rough = inverted * excess;
      const Vec3<T> solution = rough + inverted * (excess - system * rough);
      const T multiplier[3] = {solution.x, solution.y, solution.z};
      Vec3<T> stays = trial;
      T fault(0.0);
      for (Index k = 0; k < count; ++k) {
        stays = stays - multiplier[k] * stress(planes.flow(plane[k]));
        fault = max_of(fault, -multiplier[k]);
      }
      fault = max_of(fault, planes.outside(stays));
      const auto better = fault < max_of(choice.fault, tolerance);
      choice.fault = select(better, fault, choice.fault);
      for (T& one : choice.multiplier) one = select(better, T(0.0), one);
      for (Index k = 0; k < count; ++k)
        choice.multiplier[plane[k]] = select(better, multiplier[k], choice.multiplier[plane[k]]);
    }
  };

  CDEM_HD PrincipalFlow<T> flow_of(const Choice& choice, const T& compliance) const {
    const T none(0.0);
    Vec3<T> shear{none, none, none}, tension{none, none, none};
    for (const Plane plane : {s13, s23, s12})
      shear = shear + (compliance * choice.multiplier[plane]) * flow(plane);
    for (const Plane plane : {t1, t2, t3})
      tension = tension + (compliance * choice.multiplier[plane]) * flow(plane);
    const Vec3<T> all = shear + tension;
    const T mean = (shear.x + shear.y + shear.z) / T(3.0);
    const Vec3<T> deviator{shear.x - mean, shear.y - mean, shear.z - mean};
    return {.strain = {all.x, all.y, all.z},
            .shear = sqrt_of(T(2.0 / 3.0) * dot(deviator, deviator)),
            .tension = tension.x + tension.y + tension.z};
  }
};

}  // namespace cdem
