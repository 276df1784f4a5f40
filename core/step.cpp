// step.cpp - the method on one page. Each call is one folder, and one page of the theory manual.
#include "core/step.hpp"

#include "core/bonds/bonds.hpp"
#include "core/contact/contact.hpp"
#include "core/elements/elements.hpp"
#include "core/elements/nodal_mean.hpp"
#include "core/nodes/applied.hpp"
#include "core/nodes/nodes.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

void update_forces(const Model& m, State& s, Queue q, const StepPlan& plan) {
  if (pair_list_is_due(m, s)) rebuild_pair_list(m, s, plan);  // contact/pair_list, bonds/release
  set_loads_and_supports(m, s);                               // nodes/curves
  update_face_geometry(m, s, q);                              // contact/geometry
  update_bond_forces(m, s, q, plan);                          // bonds/                Eq. 13-14
  act_of_modules(m, s, q, Stage::before_contacts);            // model/modules
  if (has_contact_pairs(s)) {
    prune_pair_list_if_due(m, s, q);   // contact/pair_list
    find_target_faces(m, s, q);        // contact/narrow_phase  Eq. 6-9
    find_target_edges(m, s, q);        //                       Eq. 10-12
    transfer_released_bonds(m, s, q);  // bonds/transfer_to_contact
  }
  check_against_all_pairs(m, s);                             // contact/broad_phase
  if (has_contact_pairs(s)) update_contact_forces(m, s, q);  // contact/force         Eq. 13-14
  act_of_modules(m, s, q, Stage::after_contacts);            // model/modules, nodes/applied
  update_nodal_means(m, s, q);                               // elements/nodal_mean
  update_element_forces(m, s, q, plan);                      // elements/             Eq. 2
}

void step(const Model& m, State& s, Queue q, const StepPlan& plan) {
  update_forces(m, s, q, plan);
  advance_nodes(m, s, q, plan);  // nodes/
  receive_ghosts(s);             // ranks/
  advance_clock(s);              // nodes/time_step
  ask_what_is_due(m, s);         // contact/pair_list
  renew_step_if_due(m, s);       // nodes/time_step
}

}  // namespace cdem
