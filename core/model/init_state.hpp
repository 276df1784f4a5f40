// init_state.hpp - size the arrays of a new state.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Size every array of a new state and place the nodes; `position` has a row of 3 per node.
void init_state(const Model& model, State& state, const Real* position);

/// Gives bond points the state of an intact bond of their law.
class BeginHistory {
 public:
  BeginHistory(const Model& model, const PairSet& pairs, PairState& state);
  void operator()(Index pair, std::size_t point) const;

 private:
  OnHost<const Interface> interfaces_;
  OnHost<const Index> interface_;
  OnHost<Real> history_;
  std::size_t points_;
};

/// Bond points that may rise by dilation have a place for that, also where a stage says so.
void make_room_for_rises(const Model& model, State& state);

}  // namespace cdem
