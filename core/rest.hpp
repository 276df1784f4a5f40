// rest.hpp - what is fixed and stays as it is needs no computing. Host code.
#pragma once

#include "core/model.hpp"
#include "core/state.hpp"

namespace cdem {

/// List the blocks of elements, bonded pairs and nodes that are awake. Asleep are elements and
/// pairs of which all nodes are fixed, and fixed nodes at which nothing awake pulls and that no
/// list of contacts has: what the last step computed for them holds until the model changes.
/// Computing them again would give the same bits. (Faces that a broken bond exposes are no reason
/// to wake: bonds with a free side never sleep.)
void find_awake(const Model& model, State& state);

/// List the awake nodes anew after the lists of contacts: those that were on the last ones stay
/// awake until the next, for they have yet to forget their contacts. Finds the free blocks, too.
void list_awake_nodes(const Model& model, State& state);

/// Blocks with an item for which `is_awake` holds.
template <class Test>
void list_blocks(Index count, Column<Index>& list, Test&& is_awake) {
  list.resize(0);
  for (Index first = 0; first < count; first += block_size) {
    bool any = false;  // every item must be asked: the test takes notes
    for (Index i = first; i < first + block_size && i < count; ++i) any = is_awake(i) || any;
    if (any) list.push(first / block_size);
  }
}

/// The blocks that a step runs.
inline Blocks awake(const State& s, const Column<Index>& list) {
  static constexpr Index none = 0;  // a null pointer would stand for all
  if (s.all_awake) return {};
  return {list.size() > 0 ? list.data() : &none, Index(list.size())};
}

}  // namespace cdem
