// pressure.hpp - pressure of water, and its forces on faces and in the pores of elements.
#pragma once

#include "core/base/views.hpp"
#include "core/elements/shapes.hpp"

namespace cdem {

/// Pressure fields as they are in this step: factor (c + slope . x + keeps kept), with `kept` what
/// a point was given at the start, if the field keeps it. Below zero there is no water.
///
/// Rows of 8: c [Pa], slope x y z [Pa/m], keeps (0 or 1), factor, two pads. The last row is for
/// dry points.
struct WaterFields {
  const Real* rows;

  template <class Ids, class T>
  CDEM_HD T signed_pressure(const Ids& field, const Vec3<T>& x, const T& kept) const {
    const Ids place = indices_of([](Index i) { return 8 * i; }, field);
    const Four<T> a = fours_at(rows, place);
    const Four<T> b = fours_at(rows, indices_of([](Index i) { return i + 4; }, place));
    return b.y * (a.x + (a.y * x.x + a.z * x.y + a.w * x.z) + b.x * kept);
  }
};

/// Integral of max(0, p) N_k over a triangle, over twice its area, p linear. Where one vertex alone
/// is wet, or dry, it is a corner that the line p = 0 cuts off.
template <class T>
CDEM_HD inline void wet_part(const T (&p)[3], T (&part)[3]) {
  const T zero(0.0), one(1.0);
  const auto corner = [&](const T& sign, Index k, T(&of)[3]) {
    const Index a = (k + 1) % 3, b = (k + 2) % 3;
    const T q = sign * p[k], qa = sign * p[a], qb = sign * p[b];
    // part of the sides up to where p = 0; of no use where the others are of the same sign
    const auto cut = (q > zero) & !(qa > zero) & !(qb > zero);
    const T s = q / select(cut, q - qa, one), t = q / select(cut, q - qb, one);
    const T weight = select(cut, T(1.0 / 24) * s * t * q, zero);
    of[k] += weight * (T(4.0) - s - t), of[a] += weight * s, of[b] += weight * t;
  };
  T above[3] = {zero, zero, zero}, below[3] = {zero, zero, zero};
  for (Index k = 0; k < 3; ++k) corner(one, k, above), corner(-one, k, below);
  const T sum = p[0] + p[1] + p[2];
  const auto mostly = !(above[0] + above[1] + above[2] > zero);  // none or two or all wet
  const auto dry = (!(p[0] > zero)) & (!(p[1] > zero)) & (!(p[2] > zero));
  for (Index k = 0; k < 3; ++k) {
    const T whole = T(1.0 / 24) * (sum + p[k]) + below[k];
    part[k] = select(dry, zero, select(mostly, whole, above[k]));
  }
}

/// Force of water on faces with `count` vertices as they lie now, -int p n N_k dA.
///
/// The pressure is linear between vertices; where it is above zero, it presses: exact on triangles,
/// also where the water ends inside, and on quadrilaterals that are wet all over.
template <Index count>
struct PressOnFaces {
  InMotion nodes;
  InIndices face_nodes;  // [count][face]
  InIndices field;       // [count][face] that presses on each vertex
  InTable kept;          // [count][face]  [Pa]
  WaterFields fields;
  OutForces out;  // [face][count]  [N]

  template <class I>
  CDEM_HD void operator()(I f) const {
    using T = Number<I>;
    Vec3<T> x[count], force[count];
    T p[count];
    for (Index k = 0; k < count; ++k) {
      x[k] = nodes.position(face_nodes.at(k, f));
      p[k] = fields.signed_pressure(field.at(k, f), x[k], kept.at(k, f));
    }
    press(x, p, force);
    for (Index k = 0; k < count; ++k) out.set(f, count, k, force[k]);
  }

 private:
  template <class T>
  CDEM_HD static void press(const Vec3<T> (&x)[3], const T (&p)[3], Vec3<T> (&force)[3]) {
    const Vec3<T> n = cross(x[1] - x[0], x[2] - x[0]);  // twice the area
    T part[3];
    wet_part(p, part);
    for (Index k = 0; k < 3; ++k) force[k] = (-part[k]) * n;
  }
  template <class T>
  CDEM_HD static void press(const Vec3<T> (&x)[4], const T (&p)[4], Vec3<T> (&force)[4]) {
    const T zero(0.0);
    integrate<2>(x, p, force);
    const T least = min_of(min_of(p[0], p[1]), min_of(p[2], p[3]));
    const T most = max_of(max_of(p[0], p[1]), max_of(p[2], p[3]));
    const auto ends = (least < zero) & (most > zero);
    if (!any_of(ends)) return;
    Vec3<T> finer[4];
    integrate<8>(x, p, finer);
    for (Index k = 0; k < 4; ++k) force[k] = select(ends, finer[k], force[k]);
  }
  /// Gauss points: 2 x 2, or that in each of 4 x 4 parts.
  template <Index points, class T>
  CDEM_HD static void integrate(const Vec3<T> (&x)[4], const T (&p)[4], Vec3<T> (&force)[4]) {
    const T zero(0.0);
    for (Index k = 0; k < 4; ++k) force[k] = {zero, zero, zero};
    for (Index point = 0; point < points * points; ++point) {
      const Real a = place<points>(point % points), b = place<points>(point / points);
      const Real value[4] = {(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b};
      const Vec3<T> along = T(1 - b) * (x[1] - x[0]) + T(b) * (x[2] - x[3]);
      const Vec3<T> across = T(1 - a) * (x[3] - x[0]) + T(a) * (x[2] - x[1]);
      T pressure(0.0);
      for (Index k = 0; k < 4; ++k) pressure += T(value[k]) * p[k];
      const T share = T(-1.0 / (points * points)) * max_of(pressure, zero);
      const Vec3<T> on_area = share * cross(along, across);
      for (Index k = 0; k < 4; ++k) force[k] = force[k] + T(value[k]) * on_area;
    }
  }
  /// Two Gauss points in each of points / 2 parts of [0, 1].
  template <Index points>
  CDEM_HD static constexpr Real place(Index k) {
    const Real own = k % 2 == 0 ? 0.21132486540518712 : 0.78867513459481288;
    return (Real(k / 2) + own) / Real(points / 2);
  }
};

/// Pressure of water in the pores at every node.
struct PoresOfNodes {
  InMotion nodes;
  const Index* field;
  const Real* kept;  // [Pa]
  WaterFields fields;
  Real* pressure;  // [Pa]

  CDEM_HD void operator()(One node) const {
    const Index i = node.i;
    pressure[i] = max_of(fields.signed_pressure(field[i], nodes.position(i), kept[i]), 0.0);
  }
};

/// Force of the pressure in the pores of elements, int biot p dN_k/dx dV: the law bears the rest of
/// the stress.
template <class Shape>
struct PressInPores {
  ElementColumns<Shape> columns;
  const Real* biot;      // [material]
  const Real* values;    // [point * nodes + node] of the shape functions
  const Real* pressure;  // [node]  [Pa]
  OutForces out;         // [element][node]  [N]

  template <class I>
  CDEM_HD void operator()(I e) const {
    using T = Number<I>;
    const T part = look_up(biot, columns.element_material.at(0, e));
    T p[Shape::nodes];
    for (Index k = 0; k < Shape::nodes; ++k)
      p[k] = look_up(pressure, columns.element_nodes.at(k, e));
    const Arms<Shape, T> arms = position_arms<Shape>(columns, e);
    CornerForces<Shape, T> force;
    for (Index q = 0; q < Shape::points; ++q) {
      T here(0.0);
      for (Index k = 0; k < Shape::nodes; ++k) here += T(values[q * Shape::nodes + k]) * p[k];
      const Mat3<T> f = gradient_of<Shape>(columns, e, q, arms);
      force.add(columns, e, q, (-part * here * columns.point_volume.at(q, e)) * cofactor(f));
    }
    force.store(out, e);
  }
};

}  // namespace cdem
