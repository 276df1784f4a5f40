// time_step.hpp - the stable time step, its growth, and masses scaled for it.
#pragma once

#include <cstdint>

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Limits of the time step.
struct StepLimit {
  Real dt = 0;                         // stable step before the safety factor  [s]
  Index node = -1;                     // where it is reached
  Real element_frequency_squared = 0;  // squared frequency of its elements there  [1/s2]
  Real contact_frequency_squared = 0;  // and of its bonds and contacts  [1/s2]
  Real bond_part = 0;                  // of these, the part of bonds
};

/// The stable step is renewed every so many steps, after every rebuild of the pair list, and after
/// every step with contacts.
inline constexpr std::int64_t step_check_interval = 100;

/// A step is at most this much longer than the last. A sudden change from w dt = 1.6 to nothing or
/// back multiplies the energy of a mode by chance, both together by 1.28 on average; a slow one
/// does not (docs/theory). Contacts that come and go shorten the step and set it free again and
/// again.
inline constexpr Real step_growth = 1.01;

/// Where elements limit it, not bonds or contacts, the step grows back to this part of the stable
/// one only: the next contact shortens it at once. With q = (w dt / 2)^2 before, that multiplies
/// the energy of a mode by a number from sqrt(1 - q) to 1 / sqrt(1 - q): 0.6 to 1.67 at 0.8 of the
/// limit, 0.92 to 1.09 at 0.4.
inline constexpr Real flight_growth = 0.5;

/// Step of adaptive relaxation, as a part of the stable one: its masses are made for it, from
/// bounds that hold.
inline constexpr Real relax_safety = 0.9;

/// Contact damping up to this ratio shortens the step as one dashpot at the highest frequency does.
/// A node has many dashpots, and with a full mass matrix a cube's corner has an eighth of its mass:
/// above it the step goes with one over the ratio, else a leaning stack of cubes gains energy.
inline constexpr Real sure_contact_damping = 0.1;

StepLimit step_limit(const Model& model, const State& state);

/// Damping of a stage.
struct StageDamping {
  NodeDamping nodes;
  Real stiffness = 0, contact = 0, time = 0;  // see Model
  MaxwellBranches maxwell;
  bool lumped = false;
};

/// Stable step with the damping of a stage, before the safety factor  [s]. The model stays as it
/// is.
Real stable_step(Model& model, const State& state, const StageDamping& damping);

/// Find the stable step; the coming step shrinks to it at once and grows slowly.
void renew_step(const Model& model, State& state);

/// Is the stable step, or are the masses scaled for the step, to be renewed after this step?
bool step_is_due(const State& state);

/// End a step: the clock moves on, and the coming step grows if it may.
void advance_clock(State& state);

/// More contacts may press on a node now than the pair list expects.
void renew_step_if_due(const Model& model, State& state);

/// Adaptive relaxation: give every node the least mass that its stiffness allows in the present
/// step (Gershgorin), so that stiff and small parts hold up no others. Contacts count twice: they
/// open and close within steps, and with all nodes at the limit walls gained up to half of their
/// energy, or 12 % with a contact damping of 0.1, as a node has many dashpots. A node that becomes
/// heavier keeps its momentum, one that becomes lighter its velocity: either takes energy, which is
/// booked as damping. It lasts until `change_mass`.
void scale_masses(const Model& model, State& state);

}  // namespace cdem
