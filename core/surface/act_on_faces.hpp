// act_on_faces.hpp - surface laws at the vertices of faces.
#pragma once

#include "core/base/views.hpp"
#include "core/surface/laws.hpp"

namespace cdem {

/// Entries of a case by number: law, its parameters, and their values at this time.
struct SurfaceEntries {
  const Index* law;
  const Real* parameters;  // [entry][surface_row]
  const Real* factor;      // at this time
  const Real* acts;        // 1 or 0: it waits for its stage
};

/// Force on the vertices of faces: the traction of a law at each, times the integral of N_k n over
/// the face as it lies now. Of a pressure that is constant it is exact, also on quadrilaterals that
/// are not flat.
template <class Laws, Index count>
struct ActOnFaces {
  InMotion nodes;
  InIndices face_nodes;  // [count][face]
  InIndices entry;       // [1][face]
  SurfaceEntries entries;
  InTable place;     // [3 * count][face] where it lay as its entry began to act  [m]
  InOutTable state;  // [count * most_state][face]
  OutForces out;     // [face][count]  [N]

  template <class I>
  CDEM_HD void operator()(I f) const {
    using T = Number<I>;
    Vec3<T> x[count], area[count];
    for (Index k = 0; k < count; ++k) x[k] = nodes.position(face_nodes.at(k, f));
    integrate(x, area);
    const auto own = entry.at(0, f);
    const T zero(0.0);
    const auto acts = look_up(entries.acts, own) > zero;
    for (Index k = 0; k < count; ++k) {
      const T size = norm(area[k]);
      const Vec3<T> start{place.at(3 * k, f), place.at(3 * k + 1, f), place.at(3 * k + 2, f)};
      const SurfacePoint<T> at{.position = x[k],
                               .displacement = x[k] - start,
                               .velocity = nodes.velocity(face_nodes.at(k, f)),
                               .normal = (T(1.0) / size) * area[k],
                               .factor = look_up(entries.factor, own)};
      out.set(f, count, k, size * traction(at, own, acts, k, f));
    }
  }

 private:
  template <class T, class Ids, class Acts, class I>
  CDEM_HD Vec3<T> traction(const SurfacePoint<T>& at, const Ids& own, const Acts& acts, Index k,
                           I f) const {
    const T zero(0.0);
    Vec3<T> answer{zero, zero, zero};
    const T law = numbers_of([&](Index e) { return Real(entries.law[e]); }, own);
    Laws::for_each([&]<template <class> class Law, Index number>() {
      const auto mine = acts & (law > T(number - 0.5)) & (law < T(number + 0.5));
      if (!any_of(mine)) return;
      constexpr Index numbers = state_count<Law>;
      T now[numbers + 1];
      const Index first = k * Laws::most_state;
      for (Index j = 0; j < numbers; ++j) now[j] = state.at(first + j, f);
      const Law<T> one = Law<T>::read([&](Index p) {
        return numbers_of([&](Index e) { return entries.parameters[e * surface_row + p]; }, own);
      });
      answer = select(mine, one.respond(at, now), answer);
      for (Index j = 0; j < numbers; ++j)
        state.set(first + j, f, select(mine, now[j], state.at(first + j, f)));
    });
    return answer;
  }
  /// Integrals of N_k n over the face.
  template <class T>
  CDEM_HD static void integrate(const Vec3<T> (&x)[3], Vec3<T> (&area)[3]) {
    const Vec3<T> third = T(1.0 / 6) * cross(x[1] - x[0], x[2] - x[0]);
    for (Index k = 0; k < 3; ++k) area[k] = third;
  }
  template <class T>
  CDEM_HD static void integrate(const Vec3<T> (&x)[4], Vec3<T> (&area)[4]) {
    const T zero(0.0);
    for (Index k = 0; k < 4; ++k) area[k] = {zero, zero, zero};
    for (Index point = 0; point < 4; ++point) {
      const Real a = gauss(point % 2), b = gauss(point / 2);
      const Real value[4] = {(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b};
      const Vec3<T> along = T(1 - b) * (x[1] - x[0]) + T(b) * (x[2] - x[3]);
      const Vec3<T> across = T(1 - a) * (x[3] - x[0]) + T(a) * (x[2] - x[1]);
      const Vec3<T> part = T(0.25) * cross(along, across);
      for (Index k = 0; k < 4; ++k) area[k] = area[k] + T(value[k]) * part;
    }
  }
  CDEM_HD static constexpr Real gauss(Index k) {
    return k == 0 ? 0.21132486540518712 : 0.78867513459481288;
  }
};

}  // namespace cdem
