// node_health.hpp - how fast nodes are, and which contacts the search has lost.
#pragma once

#include "core/base/views.hpp"

namespace cdem {

/// Squared speed of each node; infinity where it or the position is no finite number.
struct SquaredSpeed {
  const Real* motion;      // rows of 8
  const Real* relax_mass;  // scaled masses; null: none are
  const Real* mass;        // [node]  [kg]

  CDEM_HD Real operator()(One node) const {
    const Real* r = motion + std::size_t(node.i) * 8;
    const Real v2 = of(node.i);
    return is_finite(v2) && is_finite(r[0] + r[1] + r[2]) ? v2 : infinity;
  }
  /// With scaled masses, of the speed with which the true one would have as much energy.
  CDEM_HD Real of(Index i) const {
    const Real* r = motion + std::size_t(i) * 8;
    const Real heavier = relax_mass ? relax_mass[i] / mass[i] : 1.0;
    return heavier * (r[4] * r[4] + r[5] * r[5] + r[6] * r[6]);
  }

 private:
  CDEM_HD static bool is_finite(Real x) { return x - x == 0; }
};

/// 1 for exposed faces with a contact lost by the search.
struct LostContact {
  const Flag *edges, *springs;  // [exposed], [slot]

  CDEM_HD Real operator()(One face) const {
    bool lost = edges[face.i] != 0;
    for (Index slot = 4 * face.i; slot < 4 * face.i + 4; ++slot) lost = lost || springs[slot] != 0;
    return lost ? 1 : 0;
  }
};

}  // namespace cdem
