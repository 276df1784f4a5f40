// energy_terms.hpp - the terms of the energy ledger.
#pragma once

#include <cstddef>
#include <iterator>
#include <string_view>

namespace cdem {

/// Sign of a term: stored or lost energy must have been supplied. What is hidden counts as
/// stored, but never below zero: energy that was made must not be hidden.
enum class EnergyKind { stored, lost, supplied, hidden };

struct EnergyTerm {
  const char* name;
  EnergyKind kind;
  const char* meaning;
  bool needs_flow = false;  // is zero where no block law flows
};

/// All terms  [J]. Ledger, checks and Python read this list.
inline constexpr EnergyTerm energy_terms[] = {
    {.name = "kinetic", .kind = EnergyKind::stored, .meaning = "motion of the nodes"},
    {.name = "strain", .kind = EnergyKind::stored, .meaning = "strain of the elements"},
    {.name = "contact",
     .kind = EnergyKind::stored,
     .meaning = "springs of contacts and of bonds that hold"},
    {.name = "bolts",
     .kind = EnergyKind::stored,
     .meaning = "bars, grout, plates, anchors and dowels of bolts"},
    {.name = "friction", .kind = EnergyKind::lost, .meaning = "slip of contacts and broken bonds"},
    {.name = "damping",
     .kind = EnergyKind::lost,
     .meaning = "damping of nodes, elements and contacts, and stopped motion"},
    {.name = "plastic",
     .kind = EnergyKind::lost,
     .meaning = "inelastic strain of the elements",
     .needs_flow = true},
    {.name = "fracture", .kind = EnergyKind::lost, .meaning = "breaking of bonds"},
    {.name = "bolt_loss",
     .kind = EnergyKind::lost,
     .meaning = "slip, yield and rupture of bolts, and the energy stored in removed bolts"},
    {.name = "radiated",
     .kind = EnergyKind::lost,
     .meaning = "work of dashpots to the ground: waves that have left"},
    {.name = "taken_out", .kind = EnergyKind::lost, .meaning = "stored energy of removed blocks"},
    {.name = "step_change",
     .kind = EnergyKind::hidden,
     .meaning = "energy of vibrations hidden by a longer step; negative: made by a shorter one"},
    {.name = "external",
     .kind = EnergyKind::supplied,
     .meaning = "work of loads, gravity and supports"},
    {.name = "water", .kind = EnergyKind::supplied, .meaning = "work of water pressure"},
    {.name = "surface", .kind = EnergyKind::supplied, .meaning = "work of surface laws"},
    {.name = "columns",
     .kind = EnergyKind::supplied,
     .meaning = "work of the ground beside sides with a free field"},
};
inline constexpr std::size_t energy_term_count = std::size(energy_terms);

/// Place of a term in the list; a name that is not there does not compile.
consteval std::size_t energy_term(std::string_view name) {
  std::size_t place = 0;
  while (energy_terms[place].name != name) ++place;
  return place;
}

}  // namespace cdem
