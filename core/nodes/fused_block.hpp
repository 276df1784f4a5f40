// fused_block.hpp - single-element blocks without contacts, loads or supports: force and motion in
// one kernel.
#pragma once

#include <type_traits>

#include "core/elements/corotational.hpp"
#include "core/nodes/mass.hpp"
#include "core/nodes/ports.hpp"

namespace cdem {

/// Rows of bonds that the nodes of fused blocks sum, for each block of `block_size` elements: first
/// those of the first corners, the first row of each element, then the second, and so on; as many
/// for all corners of all its elements, filled up with the row that adds nothing.
struct FusedRows {
  const Index* first;  // [block of elements + 1]
  const Index* row;    // ~row where the opposite is meant

  /// First place in `row` of the element of this number, and how many a corner has.
  CDEM_HD Index begin(Index element) const {
    return first[element / block_size] + element % block_size;
  }
  CDEM_HD Index most(Index element, Index corners) const {
    const Index* f = first + element / block_size;
    return (f[1] - f[0]) / (corners * block_size);
  }
};

/// Elements of these shapes have a fused kernel: it reads and writes their nodes by fours. Of
/// elements whose rock flows tets alone: a block of one hexahedron that flows is rare.
template <class Shape, class Flow = NoFlow>
inline constexpr bool has_fused_kernel =
    Shape::nodes % 4 == 0 && (std::is_same_v<Flow, NoFlow> || Shape::nodes == 4);

/// Force and motion of single-element blocks without load, support, contact or damping: no other
/// block reads or writes their nodes in this pass, so nothing is stored in between. The
/// arithmetic is as in SumNodeForces and MoveNodes, with lumped masses or with the full matrix.
template <class Shape, class Flow = NoFlow>
struct AdvanceFused {
  static_assert(has_fused_kernel<Shape, Flow>);
  static constexpr Index count = Shape::nodes;
  CorotationalForce<Shape, FollowRotation, Flow> element;
  FusedRows rows;
  InForces bond_force;
  LoadColumns loads;
  MassColumns mass;
  bool lumped;          // none of the blocks moves with its full matrix
  Real dt_before, dt;   // of the last step and of this one  [s]
  Real* motion;         // row of 8
  Real* work_external;  // [node] of gravity so far  [J]
  Real* step_change;    // [node] see MoveNodes

  template <class I>
  CDEM_HD void operator()(I e) const {
    using T = Number<I>;
    const auto first = element.columns.element_nodes.at(0, e);  // the others follow it
    const CornerForces<Shape, T> own = element.forces(e);
    T heavy[count], m[count], work[count], hidden[count];
    read(loads.gravity_mass, first, heavy);
    read(mass.mass, first, m);
    read(work_external, first, work);
    if (step_change) read(step_change, first, hidden);
    Vec3<T> weight[count], f[count];
    for (Index k = 0; k < count; ++k) {
      weight[k] = {heavy[k] * T(loads.gravity.x), heavy[k] * T(loads.gravity.y),
                   heavy[k] * T(loads.gravity.z)};
      f[k] = add_bonds(e, k, weight[k] + own.f[k]);
    }
    const T kick(0.5 * (dt_before + dt)), zero(0.0);
    for (Index k = 0; k < count; ++k) {
      Vec3<T> a = f[k];
      if (!lumped) {
        const auto matrix = look_up(mass.mass_row_first, first);
        T inverse[count];
        read(mass.inverse, after(matrix, count * k), inverse);
        a = {zero, zero, zero};
        for (Index j = 0; j < count; ++j) a = a + inverse[j] * f[j];
      }
      const auto node = after(first, k);
      const Four<T> x0 = InRows{motion}.at(node, 0), v0 = InRows{motion}.at(node, 4);
      const Vec3<T> v1 = v0.vector() + kick * Vec3<T>{a.x / m[k], a.y / m[k], a.z / m[k]};
      const Vec3<T> x1 = x0.vector() + T(dt) * v1;
      const T row[8] = {x1.x, x1.y, x1.z, zero, v1.x, v1.y, v1.z, zero};
      set_rows(motion, node, row);
      work[k] += dot(weight[k], T(0.5) * (T(dt_before) * v0.vector() + T(dt) * v1));
      if (step_change) hidden[k] += T(0.25 * (dt - dt_before)) * dot(f[k], v1 - v0.vector());
    }
    write(work_external, first, work);
    if (step_change) write(step_change, first, hidden);
  }

  static constexpr Fetching fetching{4, 4096};
  /// Not of hexahedra, see CorotationalForce.
  CDEM_HD void fetch(One e) const
    requires(count == 4)
  {
    element.columns.fetch(e);
    const Index first = element.columns.element_nodes.at(0, e);
    for (Index k = 0; k < count; ++k) InMotion{motion}.fetch(first + k);
    if (e.i % 2 == 0)  // a line of numbers serves two tets
      for (const Real* list : {loads.gravity_mass, mass.mass, (const Real*)work_external})
        cdem::fetch(list + first);
    Index place = rows.begin(e.i);
    for (Index c = 0; c < count * rows.most(e.i, count); ++c, place += block_size)
      bond_force.fetch_signed(rows.row[place]);
  }

 private:
  /// The place so many after a place, or after one a lane.
  template <class Ids>
  CDEM_HD static Ids after(const Ids& place, Index many) {
    return indices_of([&](Index i) { return i + many; }, place);
  }
  /// Entries of a list for the nodes of an element, from the place of the first.
  template <class Ids, class T>
  CDEM_HD static void read(const Real* list, const Ids& place, T* numbers) {
    for (Index k = 0; k < count; k += 4) {
      const Four<T> some = fours_at(list, after(place, k));
      numbers[k] = some.x, numbers[k + 1] = some.y, numbers[k + 2] = some.z;
      numbers[k + 3] = some.w;
    }
  }
  template <class Ids, class T>
  CDEM_HD static void write(Real* list, const Ids& place, const T* numbers) {
    for (Index k = 0; k < count; k += 4)
      set_fours(list, after(place, k),
                {numbers[k], numbers[k + 1], numbers[k + 2], numbers[k + 3]});
  }
  template <class I, class T>
  CDEM_HD Vec3<T> add_bonds(I e, Index corner, Vec3<T> f) const {
    const Index most = rows.most(e.i, count);
    Index place = rows.begin(e.i) + corner * most * block_size;
    for (Index c = 0; c < most; ++c, place += block_size)
      f = f + bond_force.signed_at(InIndices{rows.row, 1}.at(place, I{0}));
    return f;
  }
};

}  // namespace cdem
