// contact_records.hpp - rows that contacts and exposed faces are kept in.
#pragma once

#include <cstddef>

#include "core/base/math.hpp"

namespace cdem {

/// State of a contact: a row of 8 numbers.
struct ContactState {
  Real force_n;      // compression > 0  [N]
  Real penetration;  // effective: stress_free_gap - gap, or 0; less where a hysteretic contact has
                     // unloaded; -1 before it begins  [m]
  Real shear1, shear2;      // in the frame of target face or edge pair  [N]
  Real stress_free_gap;     // gap at which the contact is free of stress  [m]
  Real energy_n, energy_s;  // stored in the normal and in the shear spring  [J]
  Real approach = 0;        // stress_free_gap - gap; 0 where no interface is hysteretic  [m]

  CDEM_HD static ContactState at(const Real* rows, std::size_t place) {
    const Real* r = rows + 8 * place;
    return {.force_n = r[0],
            .penetration = r[1],
            .shear1 = r[2],
            .shear2 = r[3],
            .stress_free_gap = r[4],
            .energy_n = r[5],
            .energy_s = r[6],
            .approach = r[7]};
  }
  /// How far it lies beyond its stress-free gap, with or without force  [m].
  CDEM_HD Real depth() const { return max_of(penetration, approach); }
  /// State of a new contact.
  CDEM_HD static ContactState none() {
    ContactState s{};
    s.penetration = -1;
    return s;
  }
  CDEM_HD void store(Real* rows, std::size_t place) const {
    Real* r = rows + 8 * place;
    r[0] = force_n, r[1] = penetration, r[2] = shear1, r[3] = shear2;
    r[4] = stress_free_gap, r[5] = energy_n, r[6] = energy_s, r[7] = approach;
  }
};

/// State of the rotation spring of a semi-spring: a row of 8 numbers.
struct RollingState {
  Real couple1, couple2;  // on the mother, in the frame of the target  [N m]
  Real energy;            // stored  [J]
  Real stiffness;         // [N m]
  Vec3<Real> couple;      // on the mother  [N m]

  CDEM_HD static RollingState at(const Real* rows, std::size_t place) {
    const Real* r = rows + 8 * place;
    return {r[0], r[1], r[2], r[3], {r[4], r[5], r[6]}};
  }
  CDEM_HD void store(Real* rows, std::size_t place) const {
    Real* r = rows + 8 * place;
    r[0] = couple1, r[1] = couple2, r[2] = energy, r[3] = stiffness;
    r[4] = couple.x, r[5] = couple.y, r[6] = couple.z;
  }
};

/// A stored contact of a semi-edge: a row of 4.
struct EdgeContact {
  Index mother;  // 4 * exposed face + side
  Index face;    // exposed face to which the target edge belongs
  Index edge;    // target edge
  Index before;  // place of this contact one step ago, or -1

  CDEM_HD static EdgeContact at(const Index* rows, std::size_t place) {
    const Index* r = rows + 4 * place;
    return {.mother = r[0], .face = r[1], .edge = r[2], .before = r[3]};
  }
  CDEM_HD void store(Index* rows, std::size_t place) const {
    Index* r = rows + 4 * place;
    r[0] = mother, r[1] = face, r[2] = edge, r[3] = before;
  }
};

/// Data of an exposed face for search and forces, constant between two rebuilds:
/// one cache line.
struct ExposedRow {
  Index corner[4];  // nodes; the fourth of a triangle repeats its third
  Index beside[4];  // exposed face across side k, or -1
  Real reach;       // a little more than the farthest vertex from the centre  [m]
  Real area;        // a vertex's share of the face, Eq. 4-5  [m2]
  Real stiffness;   // modulus of the element behind over its height  [Pa/m]
  Index interface_class;
  Index unused = 0;

  CDEM_HD Index count() const { return corner[3] == corner[2] ? 3 : 4; }
  /// The vertex at the end of side k.
  CDEM_HD Index end(Index k) const { return corner[k + 1 == count() ? 0 : k + 1]; }
};

}  // namespace cdem
