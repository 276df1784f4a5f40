// views.hpp - the view of model and state for kernels of the pair lists.
#pragma once

#include "core/contact/pair_list/prune.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline EdgesOfPairs edges_of_pairs(const OuterList& outer) {
  return {.of = {outer.ee_pairs.data(), Index(outer.ee_pairs.size() / 2)},
          .sides = outer.ee_sides.data(),
          .edges = outer.ee_edges.data()};
}

}  // namespace cdem
