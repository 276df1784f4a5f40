// fast_weakening.hpp - contacts whose friction falls faster with their speed than a step can
// follow.
#pragma once

#include <vector>

#include "core/base/math.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// The worst contact of an interface. Friction that falls with the speed is explicit in it: a speed
/// that is too high by dv lowers the force by f F_n dv, which is dt f F_n sum(1/m) of dv a step
/// later. At 1 and above the contact chatters, or runs away.
struct FastWeakening {
  Index interface;
  Real ratio;        // dt f F_n sum(1/m)
  Vec3<Real> place;  // [m]
};

/// Those of the interfaces whose law says how fast friction falls, where they have pressed
/// contacts.
std::vector<FastWeakening> fast_weakenings(const Model& model, State& state);

}  // namespace cdem
