// views.hpp - the view of model and state for kernels of the pair lists.
#pragma once

#include "core/contact/pair_list/prune.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline EdgesOfPairs edges_of_pairs(const Model& m, const SearchState& search) {
  return {.of = {search.outer.ee_pairs.data(), Index(search.outer.ee_pairs.size() / 2)},
          .sides = search.outer.ee_sides.data(),
          .exposed_face = search.exposed_face.data(),
          .face_edges = m.face_edges.data()};
}

}  // namespace cdem
