// masses.hpp - change the masses that move, and stop all motion; the energy of it is booked.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Half of momentum times velocity, with the present masses  [J].
Real energy_of_motion(const Model& model, const State& state);

/// Move lumped or exact masses from now on, unscaled; the kinetic energy it takes is booked as
/// damping, and taken from the last sample.
void change_mass(Model& model, State& state, bool lumped);

/// List the nodes of blocks with dashpots to the ground, which move lumped masses, and, where the
/// model wants it, of blocks with bonds that are not released: they move
/// lumped masses, which allow a step more than twice as long, and move the full mass matrix from
/// the release of the last bond of their block on. That keeps velocities; the kinetic energy it
/// takes is booked as damping. Call it whenever pairs have been released.
void list_lumped(const Model& model, State& state);

/// Adaptive relaxation, at the time of the forces: nodes whose scaled mass has grown keep their
/// momentum. The kinetic energy it takes is booked as damping.
void slow_heavier_nodes(const Model& model, State& state);

/// Between forces and motion: zero all velocities; their energy is booked as damping. The step that
/// follows starts from rest with half a kick, as a central difference must.
void stop_motion(const Model& model, State& state);

}  // namespace cdem
