// ranks.hpp - what the ranks of a model decide together, and the rows that they send.
//
// All functions do nothing where the model is whole. All ranks must call them alike: never where
// only their own part decides.
#pragma once

#include <cstring>
#include <vector>

#include "core/model/state.hpp"
#include "core/ranks/ghosts.hpp"

namespace cdem {

/// Does it hold for any rank?
bool any_rank(const State& state, bool own);

/// Values of all ranks, one rank after the other.
template <class T>
std::vector<T> of_all_ranks(const State& state, const T& own) {
  if (!state.share.exchange) return {own};
  std::vector<T> all(state.share.exchange->count());
  state.share.exchange->gather(&own, sizeof own, all.data());
  return all;
}

/// Numbers of nodes that are not own become their owners'.
void to_ghosts(State& state, Real* rows, const SentNumbers& numbers);

/// Motion of these nodes. Part of a step.
void receive_ghosts(State& state);

/// Number of a node, and of a face, in the whole model; -1 stays.
Index whole_node(const State& state, Index node);
Index whole_face(const State& state, Index face);

}  // namespace cdem
