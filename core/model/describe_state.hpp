// describe_state.hpp - the arrays of nodes, elements and bonded pairs.
#pragma once

#include "core/model/describe_elements.hpp"
#include "core/model/describe_modules.hpp"
#include "core/model/describe_nodes.hpp"
#include "core/model/describe_pairs.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

/// Call stored(info, column) or rebuilt(by, info, column) for every array of nodes and force sets.
template <class Stored, class Rebuilt>
void describe_state(const Model& m, State& s, Stored&& stored, Rebuilt&& rebuilt) {
  describe_motion(s.nodes, stored);
  describe_relaxation(s.nodes, stored);
  describe_taken_out(s.nodes, stored);
  describe_applied(s, stored, rebuilt);
  describe_samples(s.nodes, stored);
  describe_node_forces(s, stored);
  describe_node_lists(s, rebuilt);
  describe_node_sums(s, rebuilt);
  const auto describe = [&](const auto& kind, const auto& set, auto& state) {
    describe_set(kind.name, set, state, stored, rebuilt);
  };
  for_each_element_set(m, s, describe);
  for_each_pair_set(m, s, describe);
  describe_modules(m, s, stored, rebuilt);
  for_each_element_set(m, s, [&](const auto& kind, const ElementSet& e, ElementState& es) {
    describe_tiles(kind.name, e, es.tiles, rebuilt);
  });
  describe_nodal_means(s.nodal, stored, rebuilt);
  stored({.name = "rock.moduli",
          .meaning = "moduli of the rock over those of its materials, where they differ",
          .optional = true},
         s.moduli);
  rebuilt("update_element_forces",
          {.name = "tile.force",
           .unit = "N, -",
           .meaning = "force of the elements of a tile on a node, and a pad",
           .rows = "tile_rows",
           .numbers = 4,
           .parts = {{"force", 3}, ""}},
          s.tile_force);
  stored({.name = "corner.force",
          .unit = "N, -",
          .meaning = "force of a pair or a bolt on a node, and a pad",
          .rows = "corner_rows",
          .numbers = 4,
          .parts = {{"force", 3}, ""}},
         s.corner_force);
  rebuilt("release_bonds",
          {.name = "overlaps.released",
           .meaning = "overlaps whose contacts are still to be found in the step",
           .refers_to = {"overlaps"}},
          s.released_overlaps);
}

}  // namespace cdem
