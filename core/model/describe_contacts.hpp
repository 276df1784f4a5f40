// describe_contacts.hpp - the arrays of contacts, and the forces of exposed faces.
#pragma once

#include "core/model/column_info.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// State of interface laws at the walls: part of `describe_contacts`.
template <class Stored>
void describe_history(const std::string& set, HistoryColumns& history, Stored&& stored) {
  stored({.name = set + ".history",
          .unit = "of the law",
          .meaning = "state of the law at a vertex or side",
          .rows = "slots",
          .numbers = history.width},
         history.rows);
  stored({.name = set + ".history_law",
          .meaning = "number of the law whose history it is, or -1",
          .rows = "slots",
          .numbers = history.width > 0 ? 1 : 0,
          .initial = -1},
         history.law);
}

/// Contacts of semi-springs: part of `describe_contacts`.
template <class Stored>
void describe_springs(SpringState& c, Stored&& stored) {
  stored({.name = "spring.target",
          .meaning = "exposed face in contact, or -1",
          .rows = "slots",
          .refers_to = {"exposed"},
          .initial = -1},
         c.target);
  stored({.name = "spring.target_before",
          .meaning = "the same, one step ago",
          .rows = "slots",
          .refers_to = {"exposed"},
          .initial = -1},
         c.target_before);
  stored({.name = "spring.state",
          .unit = "N, m, N, m, J, J, m",
          .meaning = "normal force, penetration, shear forces, stress-free gap, stored energies, "
                     "approach",
          .rows = "slots",
          .numbers = 8,
          .parts = {"force_n",
                    "penetration",
                    {"shear", 2},
                    "stress_free_gap",
                    "energy_n",
                    "energy_s",
                    "approach"}},
         c.state);
}

/// Their losses, and the holds of some of them: part of `describe_contacts`.
template <class Stored, class Rebuilt>
void describe_spring_losses(SpringState& c, Stored&& stored, Rebuilt&& rebuilt) {
  stored({.name = "spring.friction", .unit = "J", .meaning = "frictional work", .rows = "slots"},
         c.friction);
  stored({.name = "spring.dashpot",
          .unit = "J",
          .meaning = "work of the contact dashpot",
          .rows = "slots"},
         c.dashpot);
  stored({.name = "spring.reaction",
          .unit = "N, N/m, 1",
          .meaning = "force on the mother, stiffness, weights on the target",
          .rows = "slots",
          .numbers = 8,
          .parts = {{"force", 3}, "stiffness", {"weights", 4}}},
         c.reaction);
  stored({.name = "spring.rolling",
          .unit = "N m, J, N m, N m, -",
          .meaning =
              "couple in the frame of the target, stored energy, stiffness, couple on the mother",
          .rows = "slots",
          .numbers = 8,
          .parts = {{"couple_of_target", 2}, "energy", "stiffness", {"couple", 3}, ""},
          .optional = true},
         c.rolling);
  stored({.name = "spring.rim_action",
          .unit = "1",
          .meaning = "action coefficient of a contact held at a rim, else 0",
          .rows = "slots"},
         c.rim_action);
  stored({.name = "spring.lost",
          .meaning = "1: a loaded contact was lost by its depth",
          .rows = "slots"},
         c.lost);
  rebuilt("find_target_faces",
          {.name = "spring.unresolved",
           .meaning = "1: the step had to look for its target",
           .rows = "slots"},
          c.unresolved);
}

/// Contacts of semi-edges: part of `describe_contacts`.
template <class Stored>
void describe_edges(EdgeState& e, Stored&& stored) {
  stored({.name = "edge.first",
          .meaning = "contacts of the semi-edges of a mother face",
          .rows = "exposed",
          .layout = Layout::starts,
          .refers_to = {"edge_contacts"}},
         e.first);
  stored({.name = "edge.contact",
          .meaning = "mother side, target face, target edge, place one step ago or -1",
          .rows = "edge_contacts",
          .numbers = 4,
          .parts = {"mother_side", "target", "target_edge", "before"},
          .refers_to = {"slots", "exposed", "edges", "old_edge_states"}},
         e.contact);
  stored({.name = "edge.state",
          .unit = "N, m, N, m, J, J, m",
          .meaning = "normal force, penetration, shear forces, stress-free gap, stored energies, "
                     "approach",
          .rows = "edge_contacts",
          .numbers = 8,
          .parts = {"force_n",
                    "penetration",
                    {"shear", 2},
                    "stress_free_gap",
                    "energy_n",
                    "energy_s",
                    "approach"}},
         e.state);
  stored(
      {.name = "edge.reaction",
       .unit = "N, N/m, 1, 1, J, J",
       .meaning = "force on the mother, stiffness, places on both sides, losses of the step",
       .rows = "edge_contacts",
       .numbers = 8,
       .parts = {{"force", 3}, "stiffness", "mother_place", "target_place", "friction", "dashpot"}},
      e.reaction);
  stored({.name = "edge.friction", .unit = "J", .meaning = "frictional work", .rows = "exposed"},
         e.friction);
  stored({.name = "edge.dashpot",
          .unit = "J",
          .meaning = "work of the contact dashpot",
          .rows = "exposed"},
         e.dashpot);
  stored({.name = "edge.lost",
          .meaning = "1: a loaded contact was lost by its depth",
          .rows = "exposed"},
         e.lost);
}

/// Temporary data of a step for contacts of semi-edges: part of `describe_contacts`.
template <class Rebuilt>
void describe_found_edges(EdgeState& e, Rebuilt&& rebuilt) {
  rebuilt("find_target_edges",
          {.name = "edge.old_first",
           .meaning = "contacts of a mother face one step ago",
           .rows = "exposed",
           .layout = Layout::starts,
           .refers_to = {"old_edge_contacts"}},
          e.old_first);
  rebuilt("find_target_edges",
          {.name = "edge.old_contact",
           .meaning = "edge.contact, one step ago",
           .rows = "old_edge_contacts",
           .numbers = 4,
           .parts = {"mother_side", "target", "target_edge", "before"},
           .refers_to = {"slots", "exposed", "edges", ""}},
          e.old_contact);
  rebuilt("find_target_edges",
          {.name = "edge.old_state",
           .unit = "N, m, N, m, J, J, m",
           .meaning = "edge.state, one step ago",
           .rows = "old_edge_states",
           .numbers = 8,
           .parts = {"force_n",
                     "penetration",
                     {"shear", 2},
                     "stress_free_gap",
                     "energy_n",
                     "energy_s",
                     "approach"}},
          e.old_state);
  rebuilt(
      "find_target_edges",
      {.name = "edge.found",
       .meaning = "8 times the pair of edges of the inner list, and the way in which they touch",
       .rows = "edge_contacts"},
      e.found);
  rebuilt("find_target_edges",
          {.name = "edge.seen", .meaning = "place in inner.held", .rows = "edge_contacts"}, e.seen);
}

/// Histories that contacts of one side write, before the side takes the largest: part of
/// `describe_contacts`.
template <class Rebuilt>
void describe_contact_history(HistoryColumns& history, Rebuilt&& rebuilt) {
  rebuilt("update_contact_forces",
          {.name = "edge.contact_history",
           .unit = "of the law",
           .meaning = "output of the law of a contact",
           .rows = "edge_contacts",
           .numbers = history.width},
          history.rows);
  rebuilt("update_contact_forces",
          {.name = "edge.contact_history_law",
           .meaning = "number of that law",
           .rows = "edge_contacts",
           .numbers = history.width > 0 ? 1 : 0},
          history.law);
}

/// Forces, and the contacts that they come from: part of `describe_contacts`.
template <class Rebuilt>
void describe_forces(State& s, Rebuilt&& rebuilt) {
  ContactsByTargetState& acting = s.contacts_by_target;
  rebuilt("update_face_geometry",
          {.name = "exposed.geometry",
           .unit = "m, -, 1, m",
           .meaning = "centre x y z, sharp sides as bits, normal x y z, L (< 0: quadrilateral)",
           .rows = "exposed",
           .numbers = 8,
           .parts = {{"center", 3}, "sharp_sides", {"normal", 3}, "length"}},
          s.face_geometry);
  rebuilt("update_contact_forces",
          {.name = "exposed.contact_force",
           .unit = "N, N/m",
           .meaning = "force x y z of all contacts on a vertex, and their stiffness",
           .rows = "slots",
           .numbers = 4,
           .parts = {{"force", 3}, "stiffness"}},
          s.contact_force);
  rebuilt("update_contact_forces",
          {.name = "contacts_by_target.first",
           .meaning = "contacts that act on a face",
           .rows = "exposed",
           .layout = Layout::starts,
           .refers_to = {"acting_contacts"}},
          acting.first);
  rebuilt("update_contact_forces",
          {.name = "contacts_by_target.contact",
           .meaning = "contact that acts on the face",
           .rows = "acting_contacts",
           .refers_to = {"contacts"}},
          acting.contact);
  const Index asked = s.contact_areas.per_stiffness.size() > 0;
  rebuilt(
      "update_contact_forces",
      {.name = "contact_area.touching",
       .unit = "N/m, m, 1, -",
       .meaning = "stiffness of the contacts of a face, highest stress-free gap, is one pressed",
       .rows = "exposed",
       .numbers = 4 * asked,
       .parts = {"stiffness", "stress_free_gap", "pressed", ""}},
      s.contact_areas.touching);
  rebuilt("update_contact_forces",
          {.name = "contact_area.per_stiffness",
           .unit = "m3/N",
           .meaning = "area in contact over that stiffness",
           .rows = "exposed",
           .numbers = asked},
          s.contact_areas.per_stiffness);
}

/// Call stored(info, column) or rebuilt(by, info, column) for every array of contacts.
template <class Stored, class Rebuilt>
void describe_contacts(State& s, Stored&& stored, Rebuilt&& rebuilt) {
  describe_springs(s.springs, stored);
  describe_spring_losses(s.springs, stored, rebuilt);
  describe_history("spring", s.springs.history, stored);
  describe_edges(s.edges, stored);
  describe_history("edge", s.edges.side_history, stored);
  describe_found_edges(s.edges, rebuilt);
  describe_contact_history(s.edges.contact_history, rebuilt);
  describe_forces(s, rebuilt);
}

}  // namespace cdem
