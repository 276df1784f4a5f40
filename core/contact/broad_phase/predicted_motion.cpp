// predicted_motion.cpp - see predicted_motion.hpp.
#include "core/contact/broad_phase/predicted_motion.hpp"

#include <algorithm>
#include <vector>

#include "core/base/any_item.hpp"
#include "core/base/parallel.hpp"
#include "core/base/views.hpp"
#include "core/contact/broad_phase/exceeds_skin.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Mean velocity of the elements at every predicted node, as rigid bodies.
struct RigidMotion {
  const InMotion nodes;
  const OnHost<const Index> node_predicted;
  std::vector<Vec3<Real>> sum;  // [predicted]
  std::vector<Real> weight;

  RigidMotion(const Model& m, const State& s)
      : nodes(on_host(InMotion{s.nodes.motion.data()})),
        node_predicted(on_host(s.search.outer.node_predicted)),
        sum(s.search.outer.predicted_nodes.size(), Vec3<Real>{0, 0, 0}),
        weight(sum.size()) {
    for_each_element_set(m, s, [&](auto, const ElementSet& e, const ElementState&) { add(e); });
  }
  Vec3<Real> at(std::size_t place) const { return Real(1.0) / weight[place] * sum[place]; }

 private:
  void add(const ElementSet& e) {
    const Index corners = e.corners;
    const auto element_nodes = on_host(e.nodes);
    for (Index i = 0; i < e.count; ++i) {
      Index id[8], place[8];
      bool is_predicted = false;
      for (Index k = 0; k < corners; ++k) {
        id[k] = element_nodes[std::size_t(k) * e.stride + i];
        place[k] = node_predicted[id[k]];
        is_predicted = is_predicted || place[k] >= 0;
        if (place[k] >= 0) weight[place[k]] += 1;
      }
      if (!is_predicted) continue;
      Vec3<Real> center{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};
      bool moves = false;
      for (Index k = 0; k < corners; ++k) {
        center = center + Real(1.0) / corners * nodes.position(id[k]);
        velocity = velocity + Real(1.0) / corners * nodes.velocity(id[k]);
        moves = moves || dot(nodes.velocity(id[k]), nodes.velocity(id[k])) > 0;
      }
      if (!moves) continue;
      Mat3<Real> inertia{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
      for (Index k = 0; k < corners; ++k) {
        const Vec3<Real> arm = nodes.position(id[k]) - center;
        inertia = inertia + dot(arm, arm) * identity<Real>();
        add_outer(inertia, -arm, arm);
        spin = spin + cross(arm, nodes.velocity(id[k]));
      }
      spin = inverse(inertia) * spin;
      for (Index k = 0; k < corners; ++k)
        if (place[k] >= 0)
          sum[place[k]] = sum[place[k]] + velocity + cross(spin, nodes.position(id[k]) - center);
    }
  }
};

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

/// List the nodes of exposed faces; the smallest L of their faces stands for their skins.
void list_predicted_nodes(const Model& m, State& s) {
  const auto face_nodes = on_host(m.face_nodes);
  const auto face_length = on_host(m.face_length);
  std::vector<Real> least(m.node_count);  // 0: on no exposed face
  for (const Index face : on_host(s.search.exposed_face))
    for (Index k = 0; k < 4; ++k) {
      const Index node = face_nodes[4 * face + k];
      if (node < 0) continue;
      const Real length = face_length[face];
      least[node] = least[node] > 0 ? std::min(least[node], length) : length;
    }
  std::vector<Index> nodes;
  std::vector<Real> rows;
  for (Index i = 0; i < m.node_count; ++i) {
    if (!(least[i] > 0)) continue;
    nodes.push_back(i);
    rows.resize(rows.size() + 8);
    rows.back() = least[i];
  }
  s.search.outer.predicted_nodes.assign(nodes);
  s.search.outer.predicted.assign(rows);
  place_predicted_nodes(m, s);
}

}  // namespace

void place_predicted_nodes(const Model& m, State& s) {
  std::vector<Index> place(m.node_count, -1);
  Index next = 0;
  for (const Index node : on_host(s.search.outer.predicted_nodes)) place[node] = next++;
  s.search.outer.node_predicted.assign(place);
}

void predict_motion(const Model& m, State& s) {
  constexpr Index fewest = 20, steps = 200;
  constexpr Real most = 0.1;   // skin in parts of the smallest L of the node's faces
  constexpr Real period = 10;  // of vibrations, in steps
  // nodes of rubble that collides leave their skins long before a far lookahead time, which would
  // make long lists for nothing
  const std::int64_t lasted = s.built_step < 0 ? steps : s.step - s.built_step;
  const Real least = s.search.outer.least_skin = least_skin(s, lasted);
  const Index ahead = std::clamp<std::int64_t>(2 * lasted, fewest, steps);
  s.search.outer.lookahead_time = s.dt * (m.rebuild_interval > 0 ? m.rebuild_interval : ahead);
  s.search.outer.built_time = s.time;
  const std::vector<Real> predicted_before = fetch(s.search.outer.predicted);
  const std::vector<Index> nodes_before = fetch(s.search.outer.predicted_nodes);
  list_predicted_nodes(m, s);
  const RigidMotion rigid(m, s);
  const InMotion& nodes = rigid.nodes;
  const auto predicted_nodes = on_host(s.search.outer.predicted_nodes);
  const auto predicted = on_host(s.search.outer.predicted);
  const Index count = Index(predicted_nodes.size());
  std::vector<Vec3<Real>> change(count);  // of velocity since then; of a new one, its vibration
  for (Index w = 0; w < count; ++w) change[w] = rigid.at(w) - nodes.velocity(predicted_nodes[w]);
  for (std::size_t w = 0; w < nodes_before.size(); ++w) {
    const Real* before = predicted_before.data() + 8 * w + 4;
    const Index place = rigid.node_predicted[nodes_before[w]];
    if (place >= 0) change[place] = rigid.at(place) - Vec3<Real>{before[0], before[1], before[2]};
  }
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index w = 0; w < count; ++w) {
    const Index i = predicted_nodes[w];
    Real* row = predicted.data() + 8 * std::size_t(w);
    const Vec3<Real> v = rigid.at(w);
    const Real deviation = s.search.outer.lookahead_time * norm(change[w]) +
                           period * s.dt * norm(nodes.velocity(i) - v);
    const Real skin = std::clamp(deviation, least * row[7], most * row[7]);
    PredictedNode{nodes.position(i), v, skin}.store(row);
  }
}

bool any_exceeds_skin(const State& s, const Column<Real>& predicted, Real from,
                      Real lookahead_time) {
  const Index count = Index(s.search.outer.predicted_nodes.size());
  return any_item({}, count,
                  ExceedsSkin{.nodes = {s.nodes.motion.data()},
                              .nodes_of = {s.search.outer.predicted_nodes.data(), count},
                              .predicted = {predicted.data()},
                              .after = std::min(s.time - from, lookahead_time)});
}

}  // namespace cdem
