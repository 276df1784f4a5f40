// bolt.hpp - a bolt: parameters, and columns of its nodes, bars and crossings.
#pragma once

#include "core/base/views.hpp"
#include "core/bolts/slider.hpp"

namespace cdem {

/// Numbers of a point's row of hosts and weights: nodes of the element that it lies in.
inline constexpr Index bolt_hosts = 8;
/// Numbers of a row of BoltProperties.
inline constexpr Index bolt_properties = 5;
/// Numbers of a node's row of scratch.
inline constexpr Index bolt_scratch = 8;

struct BoltProperties {
  Real axial_stiffness;  // E A  [N]
  Real yield, crush;     // limits of the force in tension and in compression  [N]
  Real rupture_strain;   // [-]
  Real pretension;       // [N]

  CDEM_HD static BoltProperties at(const Real* rows, Index bolt) {
    const Real* r = rows + std::size_t(bolt) * bolt_properties;
    return {r[0], r[1], r[2], r[3], r[4]};
  }
};

/// Columns of the nodes of all bolts. Bar j leads from node j to node j + 1.
struct BoltNodeColumns {
  const Real *grout, *end;  // rows of 2: stiffness [N/m], limit [N]
  const Flag* grout_lost;   // 1: its rock was excavated
  Real* slip;               // of the bolt along its axis, towards the toe  [m]
  Real *grout_free, *end_free, *grout_force, *end_force;  // [m] [N]
  Real *length, *bar_free, *axial_force;                  // [m] [m] [N], tension positive
  Flag *grout_state, *end_state, *bar_state;              // SliderState
  Flag* bar_broken;                                       // BarState
  Real* scratch;  // rows of 8: position of the point x y z, length of the bar now, then the chain's
};

/// Columns of the crossings of joints.
struct DowelColumns {
  const Index* bar;         // that leads across
  const Real* dowel;        // rows of 2: stiffness [N/m], limit [N]
  Real *free_jump, *force;  // rows of 4  [m] [N]
};

}  // namespace cdem
