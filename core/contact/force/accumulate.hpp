// accumulate.hpp - forces of all contacts, summed by the faces that they act on.
#pragma once

#include "core/base/views.hpp"
#include "core/contact/geometry/face_geometry.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Contacts that have an exposed face as target: ragged rows. A semi-spring is its slot; a
/// semi-edge comes after all of them by its place in its list.
struct ContactsByTarget {
  const Index* first;    // [exposed + 1]
  const Index* contact;  // ascending in a row
};

/// The contacts of an exposed face and their targets, see list_rows.
struct ContactsOf {
  SpringColumns springs;
  EdgeColumns edges;
  Index exposed;  // how many faces there are

  template <class Do>
  CDEM_HD void visit(One m, const Do& act) const {
    for (Index slot = 4 * m.i; slot < 4 * m.i + 4; ++slot)
      if (springs.target[slot] >= 0) act(springs.target[slot], slot);
    for (Index c = edges.first[m.i]; c < edges.first[m.i + 1]; ++c)
      act(EdgeContact::at(edges.contact, c).face, 4 * exposed + c);
  }
};

/// Sum, for one exposed face, the forces of its own semi-springs and semi-edges and the reactions
/// of all others that have it as target. It goes through these in their order instead of letting
/// contacts add to nodes, so the sum has one order for any number of threads. An idle face keeps
/// its value: no node sums it.
struct AccumulateFaceForces : ContactsOf {
  FaceColumns faces;
  const Index* exposed_face;
  const Flag* listed;  // [exposed] 0: idle, on no list
  ContactsByTarget acting;
  SearchRules rules;
  Real* edge_friction;  // [exposed] lost so far in its semi-edges  [J]
  Real* edge_dashpot;   // [exposed] lost so far in their dashpots  [J]
  Real* corner_force;   // row of 4 per vertex: force x y z [N], stiffness of its contacts [N/m]

  CDEM_HD void operator()(One m) const {
    if (!listed[m.i]) return;
    const Index face = exposed_face[m.i], count = faces.vertex_count(face);
    Index c = acting.first[m.i];
    const Index last = acting.first[m.i + 1];
    Row sum[4] = {Row::zero(), Row::zero(), Row::zero(), Row::zero()};
    own(m.i, count, sum);
    for (; c < last && acting.contact[c] < 4 * exposed; ++c) {
      const Real* row = springs.reaction + std::size_t(acting.contact[c]) * 8;
      for (Index j = 0; j < count; ++j) add(sum[j], -row[4 + j], row);
    }
    for (; c < last; ++c) react(face, count, acting.contact[c] - 4 * exposed, sum);
    for (Index k = 0; k < count; ++k) sum[k].store(corner_force + (std::size_t(m.i) * 4 + k) * 4);
  }

 private:
  /// The force with its weight, the stiffness with the size of that.
  CDEM_HD static void add(Row& corner, Real weight, const Real* row) {
    corner = corner + (weight * Row::at(row)).with_size_of_last();
  }
  CDEM_HD void own(Index m, Index count, Row sum[4]) const {
    for (Index k = 0; k < count; ++k) {
      if (springs.target[4 * m + k] < 0) continue;
      const Real action = max_of(rules.action, springs.rim_action[4 * m + k]);
      const Real shared = action / Real(count);
      const Real* row = springs.reaction + (std::size_t(m) * 4 + k) * 8;
      add(sum[k], 1.0 - action, row);
      if (shared > 0)
        for (Index j = 0; j < count; ++j) add(sum[j], shared, row);
    }
    for (Index c = edges.first[m]; c < edges.first[m + 1]; ++c) {
      const Real* row = edges.reaction + std::size_t(c) * 8;
      const Index k = EdgeContact::at(edges.contact, c).mother % 4;
      add(sum[k], 1.0 - row[4], row);
      add(sum[k + 1 == count ? 0 : k + 1], row[4], row);
      edge_friction[m] += row[6];
      edge_dashpot[m] += row[7];
    }
  }
  /// Force of a semi-edge that crosses a side of this face.
  CDEM_HD void react(Index face, Index count, Index c, Row sum[4]) const {
    const Real* row = edges.reaction + std::size_t(c) * 8;
    const Index k = faces.side_on(face, EdgeContact::at(edges.contact, c).edge);
    add(sum[k], row[5] - 1.0, row);
    add(sum[k + 1 == count ? 0 : k + 1], -row[5], row);
  }
};

}  // namespace cdem
