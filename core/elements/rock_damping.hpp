// rock_damping.hpp - damping of rock that remembers the last step: Maxwell branches and Rayleigh
// dashpots beside the elastic rock.
#pragma once

#include "core/elements/shapes.hpp"
#include "core/records/branch_step.hpp"

namespace cdem {

/// Stress of Maxwell branches and Rayleigh dashpots at the Gauss points, beside that of the law.
/// Both follow from the change of strain in the last step, with the strain before it from the
/// positions of one step ago: a turning block has none. What they lose is counted by the mean
/// stress of the step on that change, which is exact for central differences.
///
/// Branch j bears weight_j S(z_j); z_j is the strain of its spring, dz/dt = dE/dt - rate_j z, moved
/// on by BranchStep. A dashpot bears S(time dE/dt).
template <class Shape>
struct RockDamping {
  static constexpr bool any = true;
  static constexpr Index branches = MaxwellBranches::count, modes = Shape::hourglass ? 12 : 0;
  static constexpr Index branch_rows = 6 * branches * Shape::points;
  static constexpr Index dashpot_rows = 6 * Shape::points + modes;

  InOutTable branch;   // [(point * branches + branch) * 6 + component][element] z; null: none
  InOutTable dashpot;  // [point * 6 + component][element] its stress in the last step  [Pa], then
                       // the rates of the hourglass modes  [m/s]; null: none
  bool ahead;          // is the state that of one step ago?
  Real dt;             // of the last step  [s]
  Real per_step;       // time of the dashpot over dt; 0 before there was a step
  BranchStep maxwell;

  /// Move on by one step: adds to the stresses, and to the forces of hourglass modes. Returns the
  /// energy lost  [J].
  template <class Rotation, class I, class T = Number<I>>
  CDEM_HD T move_on(const ElementColumns<Shape>& c, I e, bool flows,
                    const PointStrains<Shape, Rotation, T>& p, Sym3<T>* stress,
                    CornerForces<Shape, T>& force) const {
    const ElasticConstants<T> elastic = c.elastic(e);
    Sym3<T> change[Shape::points];
    find_change(c, e, flows, p, change);
    T lost(0.0);
    for (Index q = 0; q < Shape::points; ++q) {
      const T volume = c.point_volume.at(q, e);
      if (branch.data) {
        Sym3<T> sum = none<T>();
        for (Index j = 0; j < branches; ++j) {
          const Sym3<T> before = at(branch, e, q * branches + j);
          const Sym3<T> after = next(before, change[q], j);
          set(branch, e, q * branches + j, after);
          sum = sum + T(maxwell.weight[j]) * after;
          lost += T(0.5 * maxwell.weight[j]) * volume *
                  contract(elastic.stress(before + after), change[q] - (after - before));
        }
        stress[q] = stress[q] + elastic.stress(sum);
      }
      if (dashpot.data) {
        const Sym3<T> before = at(dashpot, e, q);
        const Sym3<T> after = elastic.stress(T(per_step) * change[q]);
        set(dashpot, e, q, after);
        lost += T(0.5) * volume * contract(before + after, change[q]);
        stress[q] = stress[q] + after;
      }
    }
    if constexpr (Shape::hourglass)
      if (dashpot.data) lost += brake_modes(c, e, force);
    return lost;
  }

  /// Stresses of the branches, where the report stands; returns their stored energy  [J].
  template <class Rotation, class I, class T = Number<I>>
  CDEM_HD T report(const ElementColumns<Shape>& c, I e, bool flows,
                   const PointStrains<Shape, Rotation, T>& p, Sym3<T>* stress) const {
    T stored(0.0);
    if (!branch.data) return stored;
    const ElasticConstants<T> elastic = c.elastic(e);
    Sym3<T> change[Shape::points];
    for (Sym3<T>& none_yet : change) none_yet = none<T>();
    if (ahead) find_change(c, e, flows, p, change);
    for (Index q = 0; q < Shape::points; ++q) {
      Sym3<T> sum = none<T>();
      for (Index j = 0; j < branches; ++j) {
        Sym3<T> strain = at(branch, e, q * branches + j);
        if (ahead) strain = next(strain, change[q], j);
        sum = sum + T(maxwell.weight[j]) * strain;
        stored += stored_at(elastic, c.point_volume.at(q, e), strain, j);
      }
      stress[q] = stress[q] + elastic.stress(sum);
    }
    return stored;
  }

  /// Energy stored in the branches  [J].
  template <class I, class T = Number<I>>
  CDEM_HD T stored(const ElementColumns<Shape>& c, I e) const {
    const ElasticConstants<T> elastic = c.elastic(e);
    T sum(0.0);
    for (Index q = 0; q < Shape::points; ++q)
      for (Index j = 0; j < branches; ++j)
        sum += stored_at(elastic, c.point_volume.at(q, e), at(branch, e, q * branches + j), j);
    return sum;
  }

 private:
  template <class T>
  CDEM_HD T stored_at(const ElasticConstants<T>& elastic, const T& volume, const Sym3<T>& strain,
                      Index j) const {
    return T(0.5 * maxwell.weight[j]) * volume * contract(elastic.stress(strain), strain);
  }
  template <class T>
  CDEM_HD static Sym3<T> none() {
    const T zero(0.0);
    return {zero, zero, zero, zero, zero, zero};
  }
  /// Change of the strains in the last step.
  template <class Rotation, class I, class T = Number<I>>
  CDEM_HD void find_change(const ElementColumns<Shape>& c, I e, bool flows,
                           const PointStrains<Shape, Rotation, T>& p, Sym3<T>* change) const {
    Arms<Shape, T> arms = position_arms<Shape>(c, e);
    const Arms<Shape, T> velocity = velocity_arms<Shape>(c, e);
    for (Index k = 1; k < Shape::nodes; ++k) arms.a[k] = arms[k] - T(dt) * velocity[k];
    const PointStrains<Shape, Rotation, T> was(c, e, flows, arms);
    for (Index q = 0; q < Shape::points; ++q) change[q] = p.strain[q] - was.strain[q];
  }
  template <class T>
  CDEM_HD Sym3<T> next(const Sym3<T>& strain, const Sym3<T>& change, Index j) const {
    return maxwell.next<T>(strain, change, j);
  }
  /// Dashpots of the hourglass modes; returns the energy lost  [J].
  template <class I, class T = Number<I>>
  CDEM_HD T brake_modes(const ElementColumns<Shape>& c, I e, CornerForces<Shape, T>& force) const {
    const Hourglass<T> rates(c, e, velocity_arms<Shape>(c, e));
    const T acts(per_step * dt);  // the time of the dashpot, once there was a step
    rates.add(c, e, acts, force);
    T sum(0.0);
    for (Index a = 0; a < 4; ++a) {
      const Index row = 6 * Shape::points + 3 * a;
      const Vec3<T> after = rates.amplitude[a];
      const Vec3<T> before{dashpot.at(row, e), dashpot.at(row + 1, e), dashpot.at(row + 2, e)};
      sum += dot(before + after, after);
      dashpot.set(row, e, after.x);
      dashpot.set(row + 1, e, after.y);
      dashpot.set(row + 2, e, after.z);
    }
    return T(0.5 * dt) * acts * rates.stiffness * sum;
  }
  template <class I>
  CDEM_HD static Sym3<Number<I>> at(const InOutTable& table, I e, Index number) {
    const Index row = 6 * number;
    return {table.at(row, e),     table.at(row + 1, e), table.at(row + 2, e),
            table.at(row + 3, e), table.at(row + 4, e), table.at(row + 5, e)};
  }
  template <class I>
  CDEM_HD static void set(const InOutTable& table, I e, Index number, const Sym3<Number<I>>& s) {
    const Index row = 6 * number;
    table.set(row, e, s.xx);
    table.set(row + 1, e, s.yy);
    table.set(row + 2, e, s.zz);
    table.set(row + 3, e, s.xy);
    table.set(row + 4, e, s.yz);
    table.set(row + 5, e, s.zx);
  }
};

}  // namespace cdem
