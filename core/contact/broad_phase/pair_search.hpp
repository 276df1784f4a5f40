// pair_search.hpp - driver of the broad phase: pairs that may touch before the next rebuild.
//
// The lists assume that every vertex moves on along its predicted path for a while, and they hold
// until one has left that path by its skin. So rock that moves as a whole needs no new list. Every
// test leaves room for that motion: a pair that it rejects cannot come into contact before.
#pragma once

#include "core/contact/broad_phase/element_patch.hpp"
#include "core/contact/broad_phase/pair_buffer.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Work arrays of a search and the pairs that it finds.
struct PairSearch {
  Unset<ExposedFace> exposed;
  Unset<ExposedSide> sides;
  Unset<Patch> patches;
  PairBuffers found;
};
void search_pairs(const Model& model, const State& state, PairSearch& search);

}  // namespace cdem
