// describe_pairs.hpp - the arrays of bonded pairs: part of describe_state.hpp.
#pragma once

#include "core/model/model.hpp"
#include "core/model/rebuilds.hpp"
#include "core/model/row_kinds.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// One set of bonded pairs: part of `describe_state`.
template <class Stored, class Rebuilt>
void describe_set(const char* rows, const PairSet& set, PairState& p, Stored&& stored,
                  Rebuilt&& rebuilt) {
  const std::string name = std::string(rows) + ".";
  const auto of_pair = [&](const char* column, const char* unit, const char* meaning,
                           Column<Real>& numbers) {
    stored({.name = name + column,
            .unit = unit,
            .meaning = meaning,
            .rows = rows,
            .layout = Layout::columns,
            .optional = &numbers == &p.damping_work},
           numbers);
  };
  const auto of_point = [&](const char* column, const char* unit, const char* meaning,
                            Column<Real>& numbers, Index axes = 1) {
    stored({.name = name + column,
            .unit = unit,
            .meaning = meaning,
            .rows = conforms(set) ? rows : "overlap_points",
            .numbers = axes * set.points,
            .layout = Layout::columns,
            .optional = &numbers == &p.rest || &numbers == &p.rise || &numbers == &p.dashpot},
           numbers);
  };
  stored({.name = name + "status",
          .meaning = "0: released to the contact search, 1: bonded, 2: open hinge",
          .rows = rows,
          .layout = Layout::columns},
         p.status);
  of_point("bond", "1", "1 while intact, 0 once broken", p.bond);
  of_point("slip1", "m", "plastic slip along the first axis of the pair", p.slip1);
  of_point("slip2", "m", "plastic slip along the second axis of the pair", p.slip2);
  of_point("rest", "m", "jump at which a spring is free, along the axes of the pair", p.rest, 3);
  of_point("rise", "m", "part of that jump across the pair, by dilation", p.rise);
  stored({.name = name + "history",
          .unit = "of the law",
          .meaning = "state of the law at the bond points",
          .rows = conforms(set) ? rows : "overlap_points",
          .numbers = p.history_width * set.points,
          .layout = Layout::columns},
         p.history);
  of_pair("broken_tension", "1", "springs broken in tension", p.broken_tension);
  of_pair("broken_shear", "1", "springs broken in shear", p.broken_shear);
  of_pair("jump", "m", "change of a broken pair's largest jump since it broke", p.jump);
  of_pair("jump_at_break", "m", "that jump when it broke, or -1", p.jump_at_break);
  of_pair("stored", "J", "elastic energy", p.stored);
  of_pair("fracture", "J", "energy of fracture", p.fracture);
  of_pair("friction", "J", "frictional work", p.friction);
  of_point("dashpot", "N", "force of the dashpot along the axes of the pair in the last step",
           p.dashpot, 3);
  of_pair("damping_work", "J", "work of the dashpots", p.damping_work);
  rebuilt("find_awake",
          {.name = name + "awake",
           .meaning = "blocks of pairs that are computed",
           .refers_to = {blocks_of(rows)}},
          p.awake);
}

}  // namespace cdem
