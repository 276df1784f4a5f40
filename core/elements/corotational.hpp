// corotational.hpp - element forces from the total deformation: the default, and Eq. 1 as a
// baseline.
#pragma once

#include "core/base/elementary.hpp"
#include "core/elements/shapes.hpp"
#include "core/materials/laws.hpp"

namespace cdem {

/// Elastic part of the strains.
template <class Shape, class T>
struct ElasticStrains {
  Sym3<T> part[Shape::points];

  template <class Rotation>
  CDEM_HD const Sym3<T>& of(const PointStrains<Shape, Rotation, T>&, Index q) const {
    return part[q];
  }
  /// First Piola-Kirchhoff stress. After plastic flow the axes of S and U differ, so R S alone
  /// would turn the element and would not do the work S : dU: P = R (S + A), A antisymmetric with
  /// (S + A) U symmetric.
  template <class Rotation>
  CDEM_HD Mat3<T> piola(const PointStrains<Shape, Rotation, T>& p, Index q,
                        const Sym3<T>& stress) const {
    const Sym3<T> stretch = with_trace(p.strain[q], p.own_dilatation[q]);
    return p.rotation[q] * (full(stress) + balancing(stress, full(stretch) + identity<T>()));
  }
};
/// The same where it is all of them.
struct AllElastic {
  template <class Shape, class Rotation, class T>
  CDEM_HD const Sym3<T>& of(const PointStrains<Shape, Rotation, T>& p, Index q) const {
    return p.strain[q];
  }
  template <class Shape, class Rotation, class T>
  CDEM_HD Mat3<T> piola(const PointStrains<Shape, Rotation, T>& p, Index q,
                        const Sym3<T>& stress) const {
    return p.rotation[q] * full(stress);
  }
};

/// Elements of elastic material without initial stress. Their kernels have no code
/// for it: it would cost them 4 to 11 %.
struct NoFlow {
  CDEM_HD static constexpr bool may_flow() { return false; }
  template <class Shape, class I, class Rotation, class T>
  CDEM_HD AllElastic move_on(const ElementColumns<Shape>&, I,
                             const PointStrains<Shape, Rotation, T>&) const {
    return {};
  }
};

/// Input of a law at a point: its state, row by row, and the size of its element.
template <class I>
struct StateRows {
  InOutTable history;
  Index first;  // row of the state
  InTable point_volume;
  Index points, per_cell;
  I e;

  CDEM_HD Number<I> at(Index k) const { return history.at(first + k, e); }
  /// Side of a cube of the volume of as many elements as make a cell  [m].
  CDEM_HD Number<I> size() const {
    using T = Number<I>;
    T volume(0.0);
    for (Index q = 0; q < points; ++q) volume += point_volume.at(q, e);
    return pow_of(T(Real(per_cell)) * volume, T(1.0 / 3.0));
  }
};

/// Value of the field `yielded` for number k of a law's state while it grows; four times this
/// if it ever has: 1, 2, 16, 32.
CDEM_HD constexpr Real yield_bit(Index k) { return Real((k % 2 + 1) << (4 * (k / 2))); }

/// Inelastic strain and state of the laws at the Gauss points. Initial stress S0 is the inelastic
/// strain -C^-1 : S0.
///
/// Where the dilatation is the element's mean, so is its elastic part: the pressure is averaged
/// with the operator that averages the dilatation, and the force stays the derivative of the
/// energy.
template <class Shape>
struct PointFlow {
  InOutTable history;  // [point * point_history + number][element]
  InOutTable work;     // [1][element] spent so far  [J]; without data where no material flows
  Real dt;             // of the last step  [s]

  CDEM_HD bool may_flow() const { return work.data; }

  template <class I, class Rotation, class T = Number<I>>
  CDEM_HD ElasticStrains<Shape, T> elastic_part(const ElementColumns<Shape>& c, I e,
                                                const PointStrains<Shape, Rotation, T>& p) const {
    ElasticStrains<Shape, T> strains;
    for (Index q = 0; q < Shape::points; ++q)
      strains.part[q] = history.data ? p.strain[q] - inelastic_at(e, q) : p.strain[q];
    if (history.data) use_mean_dilatation<Shape>(c, e, strains.part);
    return strains;
  }

  /// The laws move on by one step: returns the elastic strains after it. The work is by the
  /// mean stress of the step on the increment: exact for central differences.
  template <class I, class Rotation, class T = Number<I>>
  CDEM_HD ElasticStrains<Shape, T> move_on(const ElementColumns<Shape>& c, I e,
                                           const PointStrains<Shape, Rotation, T>& p) const {
    ElasticStrains<Shape, T> strains = elastic_part(c, e, p);
    Sym3<T> increment[Shape::points];
    if (any_of(flow_on(c, e, strains, increment))) book<Rotation>(c, e, strains, increment);
    return strains;
  }

  /// Subtract the plastic strain of this step from the elastic strains, and keep the laws' state;
  /// returns where any does. Where none does, the increments say nothing.
  template <class I, class T = Number<I>>
  CDEM_HD Truth<T> flow_on(const ElementColumns<Shape>& c, I e, ElasticStrains<Shape, T>& strains,
                           Sym3<T>* increment) const {
    return flow_points(c, e, strains, increment, [&](Index q, const T* state) {
      for (Index k = 0; k < BlockLaws::most_state; ++k) history.set(row(q, 6 + k), e, state[k]);
    });
  }
  /// Elastic strains at the positions of one step ago, before plastic strain since.
  template <class Rotation, class I, class T = Number<I>>
  CDEM_HD ElasticStrains<Shape, T> elastic_part_before(const ElementColumns<Shape>& c, I e) const {
    Arms<Shape, T> arms = position_arms<Shape>(c, e);
    const Arms<Shape, T> velocity = velocity_arms<Shape>(c, e);
    for (Index k = 1; k < Shape::nodes; ++k) arms.a[k] = arms[k] - T(dt) * velocity[k];
    return elastic_part(c, e, PointStrains<Shape, Rotation, T>(c, e, may_flow(), arms));
  }
  template <class I>
  CDEM_HD void add_inelastic(I e, Index q, const Sym3<Number<I>>& increment) const {
    set_inelastic(e, q, inelastic_at(e, q) + increment);
  }

  /// Result of the laws for present elastic strains; nothing is stored. `yielded` gets present
  /// and past plastic flow, see `yield_bit`.
  template <class I, class T = Number<I>>
  CDEM_HD ElasticStrains<Shape, T> after_flow(const ElementColumns<Shape>& c, I e,
                                              ElasticStrains<Shape, T> strains, T& yielded) const {
    const T none(0.0), one(1.0);
    T now[BlockLaws::most_state + 1], ever[BlockLaws::most_state + 1];
    for (Index k = 0; k < BlockLaws::most_state; ++k) {
      now[k] = ever[k] = none;
      for (Index q = 0; q < Shape::points; ++q)
        ever[k] = select(history.at(row(q, 6 + k), e) > none, one, ever[k]);
    }
    Sym3<T> increment[Shape::points];
    flow_points(c, e, strains, increment, [&](Index q, const T* state) {
      for (Index k = 0; k < BlockLaws::most_state; ++k)
        now[k] = select(state[k] > history.at(row(q, 6 + k), e), one, now[k]);
    });
    yielded = none;
    for (Index k = 0; k < BlockLaws::most_state; ++k)
      yielded += T(yield_bit(k)) * (now[k] + T(4.0) * ever[k]);
    return strains;
  }

 private:
  /// Subtract the plastic strain from the elastic strains; returns where there is any.
  template <class I, class T, class Keep>
  CDEM_HD Truth<T> flow_points(const ElementColumns<Shape>& c, I e,
                               ElasticStrains<Shape, T>& strains, Sym3<T>* increment,
                               const Keep& keep) const {
    const auto material = c.element_material.at(0, e);
    const ElasticConstants<T> elastic = c.materials.elastic(material);
    const T law = c.materials.laws(material);
    Truth<T> any = T(0.0) > T(0.0);
    bool flowed[Shape::points];
    for (Index q = 0; q < Shape::points; ++q) {
      const PointIncrement<T> now =
          flow(c.materials, material, law, elastic.stress(strains.part[q]),
               StateRows<I>{history, row(q, 6), c.point_volume, Shape::points, Shape::per_cell, e});
      flowed[q] = now.any;
      if (!now.any) continue;
      increment[q] = now.strain;
      const auto flows = contract(now.strain, now.strain) > T(0.0);
      if (any_of(flows)) keep(q, static_cast<const T*>(now.state));
      any = any | flows;
    }
    if (!any_of(any)) return any;
    const T none(0.0);
    Sym3<T> less[Shape::points];
    for (Index q = 0; q < Shape::points; ++q) {
      if (!flowed[q]) increment[q] = {none, none, none, none, none, none};
      less[q] = strains.part[q] - increment[q];
    }
    use_mean_dilatation<Shape>(c, e, less);
    for (Index q = 0; q < Shape::points; ++q)  // the other lanes keep their bits
      strains.part[q] = select(any, less[q], strains.part[q]);
    return any;
  }
  template <class Rotation, class I, class T>
  CDEM_HD void book(const ElementColumns<Shape>& c, I e, const ElasticStrains<Shape, T>& strains,
                    const Sym3<T>* increment) const {
    const ElasticConstants<T> elastic = c.elastic(e);
    const auto was = elastic_part_before<Rotation>(c, e);
    T spent(0.0);
    for (Index q = 0; q < Shape::points; ++q) {
      const Sym3<T> both = elastic.stress(was.part[q] + strains.part[q]);
      spent += T(0.5) * c.point_volume.at(q, e) * contract(both, increment[q]);
      add_inelastic(e, q, increment[q]);
    }
    // where a step is so long that it makes energy, the closing error must tell
    work.set(0, e, work.at(0, e) + max_of(spent, T(0.0)));
  }
  CDEM_HD static Index row(Index q, Index number) { return q * point_history + number; }
  template <class I>
  CDEM_HD Sym3<Number<I>> inelastic_at(I e, Index q) const {
    return {history.at(row(q, 0), e), history.at(row(q, 1), e), history.at(row(q, 2), e),
            history.at(row(q, 3), e), history.at(row(q, 4), e), history.at(row(q, 5), e)};
  }
  template <class I>
  CDEM_HD void set_inelastic(I e, Index q, const Sym3<Number<I>>& strain) const {
    history.set(row(q, 0), e, strain.xx);
    history.set(row(q, 1), e, strain.yy);
    history.set(row(q, 2), e, strain.zz);
    history.set(row(q, 3), e, strain.xy);
    history.set(row(q, 4), e, strain.yz);
    history.set(row(q, 5), e, strain.zx);
  }
};

/// Elements without damping that remembers the last step, see RockDamping. Their kernels have no
/// code for it.
struct NoRockDamping {
  static constexpr bool any = false;
};

/// Element forces of the total corotational form.
///
/// With the strain E = sym(R^T F) - I and the elastic stress S(E - Ei) in the unrotated frame, the
/// force on node k is -sum_q w J (R S) dN_k/dX. That is the exact derivative of the stored energy
/// sum_q w J W(E), because R is the closest rotation to F; so energy, linear and angular momentum
/// are kept to round-off whatever the rotation. (Written with the current B instead, the force is
/// no derivative of an energy: it differs by terms of the size of the strain.)
///
/// `damping_time` adds the stress of a dashpot, S(damping_time * rate of E) [s].
template <class OfShape, class Rotation, class Flow = NoFlow, class Damping = NoRockDamping>
struct CorotationalForce {
  using Shape = OfShape;
  ElementColumns<Shape> columns;
  Real damping_time;        // [s]
  Real dt;                  // [s]
  InOutTable damping_work;  // [1][element]  [J], taken out by the dashpot so far
  Flow flow;                // NoFlow, or PointFlow<Shape>
  Damping damping{};        // NoRockDamping, or RockDamping<Shape>

  static constexpr Fetching fetching{4, 4096};
  /// Not of hexahedra: with their 170 columns of gradients it costs more than it gains.
  CDEM_HD void fetch(One e) const
    requires(Shape::nodes == 4)
  {
    columns.fetch(e);
  }

  /// Forces on the corners of an element  [N].
  template <class I>
  CDEM_HD CornerForces<Shape, Number<I>> forces(I e) const {
    using T = Number<I>;
    const ElasticConstants<T> elastic = columns.elastic(e);
    const PointStrains<Shape, Rotation, T> p(columns, e, flow.may_flow());
    const auto strains = flow.move_on(columns, e, p);
    CornerForces<Shape, T> force;
    if constexpr (Damping::any) {
      add_damped(e, p, strains, force);
    } else {
      for (Index q = 0; q < Shape::points; ++q) {
        const Sym3<T> stress = elastic.stress(strains.of(p, q));
        force.add(columns, e, q, columns.point_volume.at(q, e) * strains.piola(p, q, stress));
      }
    }
    if constexpr (Shape::hourglass)
      Hourglass<T>(columns, e, position_arms<Shape>(columns, e)).add(columns, e, T(1.0), force);
    if (damping_time > 0) add_dashpot(e, elastic, p, force);
    return force;
  }

 private:
  /// Forces of the elastic stress and of the damping beside it.
  template <class I, class T, class Strains>
  CDEM_HD void add_damped(I e, const PointStrains<Shape, Rotation, T>& p, const Strains& strains,
                          CornerForces<Shape, T>& force) const {
    const ElasticConstants<T> elastic = columns.elastic(e);
    Sym3<T> stress[Shape::points];
    for (Index q = 0; q < Shape::points; ++q) stress[q] = elastic.stress(strains.of(p, q));
    const T lost = damping.move_on(columns, e, flow.may_flow(), p, stress, force);
    for (Index q = 0; q < Shape::points; ++q)
      force.add(columns, e, q, columns.point_volume.at(q, e) * strains.piola(p, q, stress[q]));
    damping_work.set(0, e, damping_work.at(0, e) + lost);
  }
  template <class I, class T>
  CDEM_HD void add_dashpot(I e, const ElasticConstants<T>& elastic,
                           const PointStrains<Shape, Rotation, T>& p,
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
      const Sym3<T> stress = T(damping_time) * elastic.stress(rate[q]);
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

/// Mean stress and stored energy of an element, for output and the energy ledger. The stress is
/// that which the next step will compute, the energy that of what has flowed so far.
template <class Shape, class Rotation, class Flow = PointFlow<Shape>, class Damping = NoRockDamping>
struct CorotationalReport {
  ElementColumns<Shape> columns;
  InOutTable stress;   // [6][element]  [Pa], Cauchy (to first order in the strain), global axes
  InOutTable energy;   // [1][element]  [J]
  InOutTable yielded;  // [1][element], see yield_bit; without data where no material flows
  Flow flow;           // PointFlow<Shape>, without history where no material flows, or its like
  Damping damping{};   // NoRockDamping, or RockDamping<Shape>

  template <class I>
  CDEM_HD void operator()(I e) const {
    using T = Number<I>;
    const ElasticConstants<T> elastic = columns.elastic(e);
    const PointStrains<Shape, Rotation, T> p(columns, e, flow.may_flow());
    const ElasticStrains<Shape, T> strains = flow.elastic_part(columns, e, p);
    ElasticStrains<Shape, T> shown = strains;
    if (yielded.data) {
      T bits;
      shown = flow.after_flow(columns, e, strains, bits);
      yielded.set(0, e, bits);
    }
    const T zero(0.0);
    Sym3<T> mean{zero, zero, zero, zero, zero, zero};
    T volume(0.0), stored(0.0);
    Sym3<T> all[Shape::points];
    for (Index q = 0; q < Shape::points; ++q) all[q] = elastic.stress(shown.of(p, q));
    if constexpr (Damping::any) stored += damping.report(columns, e, flow.may_flow(), p, all);
    for (Index q = 0; q < Shape::points; ++q) {
      const T w = columns.point_volume.at(q, e);
      const Sym3<T> strain = strains.of(p, q), s = all[q];
      const Mat3<T>& r = p.rotation[q];
      mean = mean + w * symmetric(r * full(s) * transpose(r));
      volume += w;
      stored += T(0.5) * w * contract(elastic.stress(strain), strain);
    }
    if constexpr (Shape::hourglass) {
      const Hourglass<T> modes(columns, e, position_arms<Shape>(columns, e));
      stored += T(0.5) * modes.stiffness * modes.square();
    }
    if constexpr (requires { flow.more_energy(columns, e); })
      stored += flow.more_energy(columns, e);
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
