// predicted_motion.hpp - where the nodes of exposed faces go until the lists are renewed:
// prediction and skin.
#pragma once

#include "core/base/math.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// A node of exposed faces as the lists see it: they are old once it is farther than its skin from
/// where it went straight on.
struct PredictedNode {
  Vec3<Real> position;  // when the lists were made  [m]
  Vec3<Real> velocity;  // predicted  [m/s]
  Real skin;            // [m]

  static PredictedNode of(const State& s, Index node) {
    const Real* r =
        s.search.outer.predicted.data() + 8 * std::size_t(s.search.outer.node_predicted[node]);
    return {{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, r[7]};
  }
  void store(Real* r) const {
    r[0] = position.x, r[1] = position.y, r[2] = position.z, r[3] = skin * skin;
    r[4] = velocity.x, r[5] = velocity.y, r[6] = velocity.z, r[7] = skin;
  }
};

/// The lists of what is close look ahead for such a part of the lookahead_time, and give every
/// vertex such a part of its skin at most, see close_lists.hpp.
inline constexpr Real inner_horizon = 0.06, inner_skin = 0.5;

/// Foresee where the nodes of exposed faces go, straight on with the rigid motion of their elements
/// (which leaves the elements' vibrations out), and how far they may deviation from there: as far
/// as they would with the change of velocity that they had since the last rebuild.
void predict_motion(const Model& model, State& state);

/// Let nodes know their places among those that are watched.
void place_predicted_nodes(const Model& model, State& state);

/// Has any watched node left the way that was predicted for it at a time [s] by more than its skin?
/// SeparatedParts the lookahead_time [s] the lists take every vertex to stand still: what sleeps
/// needs no new ones.
bool any_exceeds_skin(const State& state, const Column<Real>& predicted, Real from,
                      Real lookahead_time);

}  // namespace cdem
