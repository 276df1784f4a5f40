// rules.hpp - tolerances and coefficients that model and kernels share.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Tolerances of the search; every length is a multiple of L, the smaller of the two faces'.
struct SearchRules {
  Real indentation = 0.01;    // alpha, Eq. 3
  Real action = 0;            // coefficient of the point where the force acts: 0 is the vertex
  Real tolerance = 0.001;     // in-plane tolerance; must stay below the indentation
  Real entry = 0.05;          // a new contact may be this deep, and 1.5 times the step's approach:
                              // not less than the cones' slack
  Real depth = 0.3;           // a contact in place is kept down to here, from where it is free of
                              // stress; deeper is an error
  Real opposing = 0.02;       // faces touch only if n_m . n_t < -opposing
  Real cone = 0.05;           // slack of the normal-cone tests (a sine)
  Real approach_steps = 1.5;  // see entry
  // a filter has so much more room than the rule that decides: round-off loses no contact
  static constexpr Real filter_room = 1.000001;
  Real lifted = 0;  // [m] gap up to which contacts that have dilated are kept, at most
};

/// Maxwell branches beside the elastic rock, see elements/rock_damping.hpp; without weight there
/// are none.
struct MaxwellBranches {
  static constexpr Index count = 3;
  Real weight[count] = {};  // moduli over those of the rock  [1]
  Real rate[count] = {};    // at which their stresses relax  [1/s]

  bool any() const { return weight[0] + weight[1] + weight[2] > 0; }
  /// Moduli in fast motion over those of slow loading.
  Real stiffer() const { return 1 + weight[0] + weight[1] + weight[2]; }
};

/// Damping of the nodes' motion.
struct NodeDamping {
  Real local;  // Cundall's, fraction of the unbalanced force, against the velocity
  Real mass;   // mass-proportional  [1/s]
};

}  // namespace cdem
