// ports.hpp - all ways in which a force comes to a node, and the order in which the node sums them.
#pragma once

#include "core/base/views.hpp"

namespace cdem {

/// Forces on nodes from outside: gravity, forces that follow curves of time, unreleased
/// forces of removed blocks, and applied forces.
struct LoadColumns {
  Vec3<Real> gravity;        // [m/s2]
  const Real* gravity_mass;  // [node] mass that gravity acts on  [kg]
  const Index* load_first;   // [node + 1]
  const Index* load_curve;   // curve that scales the load
  const Real* load_force;    // row of 4  [N]
  const Real* curve_value;   // [curve] factors at the time of this step
  const Real* relief;        // row of 4 a node, see run/excavate.hpp; null: none  [N]
  Real relief_part;          // that is left in this step
  const Real* applied;       // row of 4 a node, sum of forces of modules; null: none  [N]

  CDEM_HD Row at(Index node) const {
    Row f = gravity_mass[node] * Row::of(gravity.x, gravity.y, gravity.z);
    for (Index l = load_first[node]; l < load_first[node + 1]; ++l)
      f = f + curve_value[load_curve[l]] * Row::at(load_force + std::size_t(l) * 4);
    if (relief) f = f + relief_part * Row::at(relief + std::size_t(node) * 4);
    if (applied) f = f + Row::at(applied + std::size_t(node) * 4);
    return f;
  }
};

/// Which rows of forces belong to a node.
struct CornerLists {
  const Index* tile_first;  // [node + 1], rows of tiles of elements
  InForces tile_force;
  const Index* first;   // [node + 1], rows of bonded pairs and bolts
  const Index* corner;  // ~row if the node takes the negative of that row
  InForces corner_force;
  const Index* contact_first;  // [node + 1], rows of exposed faces that may have contacts
  const Index* contact_corner;
  InForces contact_force;  // rows: force, stiffness

  /// Add a node's rows in the order of its lists: elements, bonds and bolts, contacts.
  CDEM_HD Row sum(Index node, Row f) const {
    for (Index t = tile_first[node]; t < tile_first[node + 1]; ++t) f = f + tile_force.at(t);
    for (Index c = first[node]; c < first[node + 1]; ++c)
      f = f + corner_force.signed_row(corner[c]);
    for (Index c = contact_first[node]; c < contact_first[node + 1]; ++c)
      f = f + contact_force.at(contact_corner[c]);
    return f;
  }
};

/// The ports of a node, and three questions: their sum, may the fused kernel move the node,
/// and does something from outside act on it? A new port is a member here, with a line in each
/// answer. The order of the sum is part of the results.
struct NodePorts {
  LoadColumns loads;
  const Flag* has_applied;  // [node] may modules apply forces to it? null: to none
  const Index* ground;      // [node] row of its dashpots, see nodes/dashpots.hpp, or -1; null: none
  CornerLists corners;

  CDEM_HD Row sum(Index node) const { return corners.sum(node, loads.at(node)); }

  /// Do only gravity, elements, bonds and bolts act? The fused kernel sums no other port.
  CDEM_HD bool is_plain(Index node) const {
    return !is_loaded(node) && corners.contact_first[node] == corners.contact_first[node + 1];
  }
  /// Does something but gravity act from outside, now or later? Asked of lists where there are any,
  /// not of values: a pressure may begin in a later step.
  CDEM_HD bool is_loaded(Index node) const {
    if (loads.load_first[node] < loads.load_first[node + 1]) return true;
    if (has_applied && has_applied[node]) return true;
    if (ground && ground[node] >= 0) return true;
    if (!loads.relief) return false;
    const Vec3<Real> kept = Row::at(loads.relief + std::size_t(node) * 4).vector();
    return kept.x != 0 || kept.y != 0 || kept.z != 0;
  }
};

}  // namespace cdem
