// branch_step.hpp - Maxwell branches over one step.
#pragma once

#include "core/base/elementary.hpp"
#include "core/records/rules.hpp"

namespace cdem {

/// Numbers of the branches over one step, for a strain that is linear in it: the strain z of the
/// spring of branch j becomes left_j z + share_j (change of the strain), left = exp(-rate dt),
/// share = (1 - left) / (rate dt).
struct BranchStep {
  static constexpr Index count = MaxwellBranches::count;
  Real weight[count] = {}, left[count] = {}, share[count] = {};

  BranchStep() = default;
  BranchStep(const MaxwellBranches& maxwell, Real dt) {
    for (Index j = 0; j < count; ++j) {
      const Real passed = maxwell.rate[j] * dt;
      weight[j] = maxwell.weight[j];
      left[j] = exp_of(-passed);
      share[j] = passed > 0 ? (1 - left[j]) / passed : 1;
    }
  }
  template <class T, class Strain>
  CDEM_HD Strain next(const Strain& spring, const Strain& change, Index j) const {
    return T(left[j]) * spring + T(share[j]) * change;
  }
};

}  // namespace cdem
