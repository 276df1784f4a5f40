// step.hpp - the time loop, and what may be asked of it.
#pragma once

#include <string>

#include "core/model.hpp"
#include "core/state.hpp"

namespace cdem {

/// Energies at the time of the last sampled forces  [J]. Lost and stored energy count positive.
struct Energies {
  Real kinetic = 0, strain = 0, contact = 0;
  Real friction = 0, damping = 0, fracture = 0, external = 0;
  Real start = 0;  // stored and kinetic energy when the ledger was opened
  Real error = 0;  // what does not close, as a fraction of the largest term so far
};

/// What limits the time step.
struct StepLimit {
  Real dt = 0;        // stable step before the safety factor  [s]
  Index node = -1;    // where it is reached
  Real element2 = 0;  // squared frequency of its elements there  [1/s2]
  Real contact2 = 0;  // and of its bonds and contacts  [1/s2]
};

enum class Outcome {
  steps_done,
  time_reached,
  converged,
  not_finite,
  too_fast,
  lost_contact,
  missed_contact
};

/// The way to rest of a static stage, besides damping that the model has already.
enum class Relaxation { none, kinetic, adaptive };

/// When to come back from the loop.
struct Goal {
  std::int64_t steps = 0;    // at most
  Real end_time = 1e300;     // [s]
  Real unbalance_limit = 0;  // 0: do not look
  std::int64_t check_interval = 20;
  Relaxation relaxation = Relaxation::none;
};

struct Report {
  Outcome outcome = Outcome::steps_done;
  Index culprit = -1;  // node, or exposed face for a lost contact
  Real value = 0;
};

/// Size every array of a new state and place the nodes; `position` has a row of 3 per node.
void start(const Model& model, State& state, const Real* position);
/// Ready a new or a restored state for the loop: lists and stable step.
void prepare(const Model& model, State& state);
/// Factors of the load and velocity curves for the step that begins now.
void evaluate_curves(const Model& model, State& state);
Report run(const Model& model, State& state, const Goal& goal);

Energies energies(const Model& model, const State& state);
/// Remember the largest term of the ledger so far, which the closing error is measured against.
void keep_energy_scale(const Model& model, State& state);
Real unbalance_ratio(const Model& model, const State& state);
void renew_step(const Model& model, State& state);
StepLimit step_limit(const Model& model, const State& state);
/// Stress of every element where the nodes are now.
void report_stress(const Model& model, State& state);

/// Move lumped or exact masses from now on, unscaled; what kinetic energy that takes is booked as
/// damping.
void change_mass(Model& model, State& state, bool lumped);
/// Adaptive relaxation: give every node the least mass that its stiffness allows in the present
/// step (Gershgorin), so that stiff and small parts hold up no others. What kinetic energy that
/// takes is booked as damping. It lasts until `change_mass`.
void scale_masses(const Model& model, State& state);
/// Between forces and motion: zero all velocities; their energy is booked as damping. The step that
/// follows starts from rest with half a kick, as a central difference must.
void stop_motion(const Model& model, State& state);

// refresh.cpp
bool refresh_is_due(const Model& model, State& state);
void refresh_contacts(Model const& model, State& state);
/// Make the table of exposed faces anew, after a refresh or a restart.
void list_exposed(const Model& model, State& state);
/// Set the stress-free gap of springs that overlap at the start; returns the deepest overlap [m].
Real adopt_overlaps(const Model& model, State& state, Index& count, Index& face);
/// Compare the contacts that the step has just found with an all-pairs search.
Index count_missed_contacts(const Model& model, State& state);

}  // namespace cdem
