// pair_search.hpp - driver of the broad phase: what may touch before the lists are renewed.
//
// The lists assume that every vertex goes straight on at its present velocity for a while, and
// they are good until one has left that path by its skin. So rock that moves as a whole needs
// no new lists. Every test leaves room for that motion: what it rejects cannot come into contact
// before.
#pragma once

#include "core/contact/broad_phase/element_patch.hpp"
#include "core/contact/broad_phase/pair_buffer.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// What a search works with and what it finds. It is kept from rebuild to rebuild for its memory
/// only, which the system would have to hand out anew.
struct PairSearch {
  Unset<ExposedFace> exposed;
  Unset<ExposedSide> sides;
  Unset<Patch> patches;
  PairBuffers found;
};
void search_pairs(const Model& model, const State& state, PairSearch& search);

}  // namespace cdem
