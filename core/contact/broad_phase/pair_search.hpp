// pair_search.hpp - driver of the broad phase: pairs that may touch before the next rebuild.
//
// The lists assume that every vertex moves on along its predicted path for a while, and they hold
// until one has left that path by its skin. So rock that moves as a whole needs no new list. Every
// test leaves room for that motion: a pair that it rejects cannot come into contact before.
#pragma once

#include "core/base/column.hpp"
#include "core/bonds/bonded_overlaps.hpp"
#include "core/contact/broad_phase/moving_edge.hpp"
#include "core/contact/broad_phase/pair_items.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Work arrays of a search, and the pairs that it finds.
struct PairSearch {
  Column<ExposedFace> exposed;
  Column<ExposedSide> sides;  // [exposed][4]
  Column<Patch> patches;
  Column<Index> edge_sides;  // of the edges of all patches, see EdgePairs
  Bonded bonded;
  Column<PatchPair> pairs;  // of a movable patch with a later one, or one that is not movable
  Column<VertexFaceItem> vertex_faces;
  Column<MovingEdge> moving;  // edges of all patches
  Column<EdgeItem> edges;

  // What is listed before it is tested takes 7 kB a patch: so many are searched at once, and 16
  // times as many pairs of patches. The lists do not depend on it.
  Index at_once = 65536;
};

PairContext pair_context(const Model& model, const State& state, const PairSearch& search);

/// Make the exposed faces, their sides and patches.
void list_patches(const Model& model, const State& state, PairSearch& search);
/// And the pairs that may touch.
void search_pairs(const Model& model, const State& state, PairSearch& search);

}  // namespace cdem
