// predicted_motion.cpp - see predicted_motion.hpp.
#include "core/contact/broad_phase/predicted_motion.hpp"

#include <algorithm>

#include "core/base/primitives.hpp"
#include "core/contact/broad_phase/exceeds_skin.hpp"
#include "core/contact/broad_phase/predict_nodes.hpp"
#include "core/model/element_corners.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

namespace {

/// Smallest skin of a node, in parts of the smallest L of its faces: wide skins make long lists,
/// thin ones lists that do not last. Both cost about the same where lists last some fifty steps.
Real least_skin(const State& s, std::int64_t lasted) {
  constexpr Index short_lived = 36, long_lived = 72;
  constexpr Real thinnest = 0.001, widest = 0.03, change = 1.5;
  if (s.search.outer.skin_exceeded && lasted < short_lived)
    return std::min(change * s.search.outer.least_skin, widest);
  if (lasted > long_lived) return std::max(s.search.outer.least_skin / change, thinnest);
  return s.search.outer.least_skin;
}

/// List the nodes of exposed faces, and the smallest L of the faces of each node  [m].
Column<Real> list_predicted_nodes(const Model& m, State& s) {
  Column<Real> least;
  least.renew(m.node_count);
  set_all({}, m.node_count, least.data(), infinity);
  for_each_item({}, Index(s.search.exposed_face.size()),
                LowerLengths{.exposed_face = s.search.exposed_face.data(),
                             .face_nodes = m.face_nodes.data(),
                             .face_length = m.face_length.data(),
                             .alone = runs_alone(),
                             .least = least.data()});
  select_items({}, m.node_count, IsOnExposed{least.data()}, s.search.outer.predicted_nodes);
  place_predicted_nodes(m, s);
  return least;
}

RigidMotion rigid_motion(const Model& m, const State& s) {
  return {.nodes = {s.nodes.motion.data()},
          .elements = element_corners(m, s),
          .first = s.nodes.element_first.data(),
          .corner = s.nodes.element_corner.data()};
}

}  // namespace

void place_predicted_nodes(const Model& m, State& s) {
  const Column<Index>& nodes = s.search.outer.predicted_nodes;
  Column<Index>& place = s.search.outer.node_predicted;
  place.renew(m.node_count);
  set_all({}, m.node_count, place.data(), Index(-1));
  for_each_item({}, Index(nodes.size()), PlacePredicted{nodes.data(), place.data()});
}

namespace {

constexpr Real vibration_period = 10;  // [steps]

/// How long the last list has held, and how far the next one looks ahead  [steps].
struct Outlook {
  std::int64_t lasted;
  Index ahead;

  static Outlook of(const Model& m, const State& s) {
    constexpr Index fewest = 20, steps = 200;
    // nodes of rubble that collides leave their skins long before a far lookahead time, which would
    // make long lists for nothing
    const std::int64_t lasted = s.built_step < 0 ? steps : s.step - s.built_step;
    const Index ahead = std::clamp<std::int64_t>(2 * lasted, fewest, steps);
    return {lasted, m.rebuild_interval > 0 ? m.rebuild_interval : ahead};
  }
};

/// Paths of nodes that other ranks own.
void take_paths(const Model& m, State& s) {
  if (!s.share.exchange) return;
  const OuterList& outer = s.search.outer;
  const Index count = Index(outer.predicted_nodes.size());
  const Index* const nodes = outer.predicted_nodes.data();
  Real* const predicted = s.search.outer.predicted.data();
  Column<Real> by_node;
  by_node.renew(8 * std::size_t(m.node_count));
  set_all({}, Index(by_node.size()), by_node.data(), Real(0));
  for_each_item({}, count, PathsByNode{nodes, predicted, by_node.data()});
  to_ghosts(s, by_node.data(), {.width = 8, .count = 8});
  for_each_item({}, count,
                TakePaths{.predicted_nodes = nodes,
                          .own = s.share.counted("nodes").own,
                          .by_node = by_node.data(),
                          .predicted = predicted});
}

}  // namespace

namespace {

/// The coming prediction, from the last one.
PredictNodes coming_prediction(const Model& m, const State& s) {
  const Outlook outlook = Outlook::of(m, s);
  const OuterList& outer = s.search.outer;
  const bool known = outer.node_predicted.size() > 0;
  return {.rigid = rigid_motion(m, s),
          .predicted_nodes = nullptr,
          .length = nullptr,
          .place_before = known ? outer.node_predicted.data() : nullptr,
          .predicted_before = outer.predicted.data(),
          .lookahead_time = s.dt * outlook.ahead,
          .period = vibration_period * s.dt,
          .least = least_skin(s, outlook.lasted),
          .most = widest_skin,
          .predicted = nullptr};
}

}  // namespace

Column<Real> coming_paths(const Model& m, const State& s, const Column<Real>& length) {
  Column<Real> rows;
  rows.renew(4 * std::size_t(m.node_count));
  for_each_item({}, m.node_count,
                ListComingPaths{{coming_prediction(m, s)}, length.data(), rows.data()});
  return rows;
}

bool leaves_fence(const Model& m, const State& s) {
  const LeavesFence leaves{.paths = {coming_prediction(m, s)},
                           .own = s.share.counted("nodes").own,
                           .fence = s.share.fence.data()};
  return any_rank(s, any_item({}, m.node_count, leaves));
}

void predict_motion(const Model& m, State& s) {
  OuterList& outer = s.search.outer;
  const Outlook outlook = Outlook::of(m, s);
  outer.least_skin = least_skin(s, outlook.lasted);
  outer.lookahead_time = s.dt * outlook.ahead;
  outer.built_time = s.time;
  Column<Index> place_before;
  Column<Real> predicted_before;
  place_before.swap(outer.node_predicted);
  predicted_before.swap(outer.predicted);
  const Column<Real> length = list_predicted_nodes(m, s);
  const Index count = Index(outer.predicted_nodes.size());
  outer.predicted.renew(8 * std::size_t(count));
  for_each_item({}, count,
                PredictNodes{.rigid = rigid_motion(m, s),
                             .predicted_nodes = outer.predicted_nodes.data(),
                             .length = length.data(),
                             .place_before = place_before.data(),
                             .predicted_before = predicted_before.data(),
                             .lookahead_time = outer.lookahead_time,
                             .period = vibration_period * s.dt,
                             .least = outer.least_skin,
                             .most = widest_skin,
                             .predicted = outer.predicted.data()});
  take_paths(m, s);
}

void ask_if_skin_is_exceeded(const State& s, const Column<Real>& predicted, Real from,
                             Real lookahead_time, Flag* answer) {
  const Index count = Index(s.search.outer.predicted_nodes.size());
  raise_if_any({}, count,
               ExceedsSkin{.nodes = {s.nodes.motion.data()},
                           .nodes_of = {s.search.outer.predicted_nodes.data(), count},
                           .predicted = {predicted.data()},
                           .after = std::min(s.time - from, lookahead_time)},
               answer);
}

}  // namespace cdem
