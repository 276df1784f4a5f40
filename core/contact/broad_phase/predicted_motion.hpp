// predicted_motion.hpp - where the nodes of exposed faces go until the lists are renewed:
// prediction and skin.
#pragma once

#include "core/base/math.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// A node of exposed faces as the lists see it: they are old once it is farther than its skin from
/// where it went straight on.
struct WatchedNode {
  Vec3<Real> position;  // when the lists were made  [m]
  Vec3<Real> velocity;  // foreseen  [m/s]
  Real skin;            // [m]

  static WatchedNode of(const State& s, Index node) {
    const Real* r = s.search.watch.data() + 8 * std::size_t(s.search.node_watch[node]);
    return {{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, r[7]};
  }
  void store(Real* r) const {
    r[0] = position.x, r[1] = position.y, r[2] = position.z, r[3] = skin * skin;
    r[4] = velocity.x, r[5] = velocity.y, r[6] = velocity.z, r[7] = skin;
  }
};

/// The lists of what is close look ahead for such a part of the horizon, and give every vertex such
/// a part of its skin at most, see close_lists.hpp.
inline constexpr Real close_way = 0.06, close_skin = 0.5;

/// Foresee where the nodes of exposed faces go, straight on with the rigid motion of their elements
/// (which leaves the elements' vibrations out), and how far they may stray from there: as far as
/// they would with the change of velocity that they had since the last refresh.
void foresee_motion(const Model& model, State& state);

/// Let nodes know their places among those that are watched.
void place_watched(const Model& model, State& state);

/// Has any watched node left the way that was foreseen for it at a time [s] by more than its skin?
/// Beyond the horizon [s] the lists take every vertex to stand still: what rests needs no new ones.
bool any_strayed(const State& state, const Column<Real>& watch, Real from, Real horizon);

}  // namespace cdem
