// predicted_motion.hpp - prediction and skin of the nodes of exposed faces until the next rebuild.
#pragma once

#include "core/contact/broad_phase/predicted_node.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline PredictedNodes predicted_nodes(const State& s) {
  return {s.search.outer.node_predicted.data(), s.search.outer.predicted.data()};
}

/// Skin of a node at most, in parts of the smallest L of its faces.
inline constexpr Real widest_skin = 0.1;

/// Predict the paths of the nodes of exposed faces, straight on with the rigid motion of their
/// elements (which leaves the elements' vibrations out), and their skins: the deviation that the
/// change of velocity since the last rebuild would make once more.
void predict_motion(const Model& model, State& state);

/// Velocities of the next prediction [m/s] and skins at most [m] of all nodes, rows of 4; for faces
/// up to these L  [m].
Column<Real> coming_paths(const Model& model, const State& state, const Column<Real>& length);

/// May the next prediction lead a node of any rank out of the box that ghosts were found for?
bool leaves_fence(const Model& model, const State& state);

/// Give nodes their places among the predicted ones.
void place_predicted_nodes(const Model& model, State& state);

/// Raise a flag of an Answer if a node has left the path that was predicted for it at time `from`
/// [s] by more than its skin. Beyond the lookahead time [s] the lists take every vertex to stand
/// still: sleeping parts need no rebuild.
void ask_if_skin_is_exceeded(const State& state, const Column<Real>& predicted, Real from,
                             Real lookahead_time, Flag* answer);

}  // namespace cdem
