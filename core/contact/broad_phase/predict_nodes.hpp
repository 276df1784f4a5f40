// predict_nodes.hpp - kernels that predict the paths and skins of the nodes of exposed faces.
#pragma once

#include "core/base/parallel.hpp"
#include "core/base/views.hpp"
#include "core/contact/broad_phase/predicted_node.hpp"
#include "core/records/corners_by_node.hpp"

namespace cdem {

/// The nodes of an exposed face learn its L; they keep the smallest.
struct LowerLengths {
  const Index *exposed_face, *face_nodes;
  const Real* face_length;
  bool alone;   // see lower_to
  Real* least;  // [node], initially infinite  [m]

  CDEM_HD void operator()(One x) const {
    const Index face = exposed_face[x.i];
    for (Index k = 0; k < 4; ++k) {
      const Index node = face_nodes[4 * std::size_t(face) + k];
      if (node >= 0) lower_to(least[node], face_length[face], alone);
    }
  }
};
/// Is a node on an exposed face?
struct IsOnExposed {
  const Real* least;
  CDEM_HD bool operator()(One node) const { return least[node.i] < infinity; }
};
struct PlacePredicted {
  const Index* nodes;  // [predicted]
  Index* place;        // [node]
  CDEM_HD void operator()(One item) const { place[nodes[item.i]] = item.i; }
};

/// Mean velocity of the elements at a node, as rigid bodies.
struct RigidMotion {
  InMotion nodes;
  ElementCorners elements;
  const Index *first, *corner;  // [node + 1] of its elements

  CDEM_HD Vec3<Real> at(Index node) const {
    Vec3<Real> sum{0, 0, 0};
    for (Index c = first[node]; c < first[node + 1]; ++c)
      elements.with_element(corner[c], [&](const ElementCorners::Set& set, Index i) {
        add(set, i, nodes.position(node), sum);
      });
    return Real(1.0) / Real(first[node + 1] - first[node]) * sum;
  }

 private:
  CDEM_HD void add(const ElementCorners::Set& e, Index i, const Vec3<Real>& at,
                   Vec3<Real>& sum) const {
    const Real part = Real(1.0) / e.corners;
    Vec3<Real> center{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};
    bool moves = false;
    for (Index k = 0; k < e.corners; ++k) {
      const Index node = e.nodes.at(k, i);
      const Vec3<Real> v = nodes.velocity(node);
      center = center + part * nodes.position(node);
      velocity = velocity + part * v;
      moves = moves || dot(v, v) > 0;
    }
    if (!moves) return;
    Mat3<Real> inertia{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (Index k = 0; k < e.corners; ++k) {
      const Index node = e.nodes.at(k, i);
      const Vec3<Real> arm = nodes.position(node) - center;
      inertia = inertia + dot(arm, arm) * identity<Real>();
      add_outer(inertia, -arm, arm);
      spin = spin + cross(arm, nodes.velocity(node));
    }
    spin = inverse(inertia) * spin;
    sum = sum + velocity + cross(spin, at - center);
  }
};

/// Path of a node, and its skin: the deviation that the change of velocity since the last rebuild
/// would make once more, and some of its vibration.
struct PredictNodes {
  RigidMotion rigid;
  const Index* predicted_nodes;
  const Real* length;         // [node] smallest L of its faces  [m]
  const Index* place_before;  // [node] among the rows before, or -1; null: there were none
  const Real* predicted_before;
  Real lookahead_time, period;  // of vibrations  [s]
  Real least, most;             // skin in parts of that length
  Real* predicted;              // rows of PredictedNode

  CDEM_HD void operator()(One item) const {
    const Index node = predicted_nodes[item.i];
    const Vec3<Real> v = rigid.at(node), own = rigid.nodes.velocity(node);
    const Real deviates = deviation(node, v, before(node, own));  // of a new one, its vibration
    const Real thin = least * length[node], wide = most * length[node];
    const Real skin = deviates < thin ? thin : wide < deviates ? wide : deviates;
    PredictedNode{rigid.nodes.position(node), v, skin}.store(predicted + 8 * std::size_t(item.i));
  }
  CDEM_HD Real deviation(Index node, const Vec3<Real>& v, const Vec3<Real>& before) const {
    return lookahead_time * norm(v - before) + period * norm(rigid.nodes.velocity(node) - v);
  }
  /// The velocity of the last prediction, or another one where there was none.
  CDEM_HD Vec3<Real> before(Index node, const Vec3<Real>& own) const {
    const Index place = place_before ? place_before[node] : -1;
    return place < 0 ? own : PredictedNode::at(predicted_before + 8 * std::size_t(place)).velocity;
  }
};

// Of ranks: the path of a node that is not own is its owner's.

/// Copy the rows of predicted nodes to places by node.
struct PathsByNode {
  const Index* predicted_nodes;
  const Real* predicted;
  Real* by_node;  // rows of 8
  CDEM_HD void operator()(One item) const {
    const Real* from = predicted + 8 * std::size_t(item.i);
    Real* to = by_node + 8 * std::size_t(predicted_nodes[item.i]);
    Row::at(from).store(to);
    Row::at(from + 4).store(to + 4);
  }
};
/// Take the rows of nodes that are not own; only the owner asks whether they leave their skins.
struct TakePaths {
  const Index* predicted_nodes;
  const Flag* own;
  const Real* by_node;
  Real* predicted;
  CDEM_HD void operator()(One item) const {
    const Index node = predicted_nodes[item.i];
    if (own[node]) return;
    const Real* from = by_node + 8 * std::size_t(node);
    Real* to = predicted + 8 * std::size_t(item.i);
    Row::at(from).store(to);
    Row::at(from + 4).store(to + 4);
    to[3] = infinity;  // see PredictedNode
  }
};

/// Paths and skins that the coming prediction may give nodes, of known or of new exposed faces.
struct ComingPaths {
  PredictNodes predict;

  /// The skin at most of a node with faces up to this L.
  CDEM_HD Real skin(Index node, const Vec3<Real>& velocity, Real length) const {
    const Real known = predict.deviation(node, velocity, predict.before(node, velocity));
    const Real own = predict.deviation(node, velocity, predict.rigid.nodes.velocity(node));
    const Real most = max_of(max_of(known, own), predict.least * length);
    return min_of(most, predict.most * length);
  }
};

/// Write them: velocity, skin.
struct ListComingPaths {
  ComingPaths paths;
  const Real* length;  // [node] largest L of its faces  [m]
  Real* rows;          // rows of 4
  CDEM_HD void operator()(One node) const {
    const Vec3<Real> v = paths.predict.rigid.at(node.i);
    Real* to = rows + 4 * std::size_t(node.i);
    to[0] = v.x, to[1] = v.y, to[2] = v.z, to[3] = paths.skin(node.i, v, length[node.i]);
  }
};

/// May the coming prediction lead an own node out of the box that ghosts were found for?
struct LeavesFence {
  ComingPaths paths;
  const Flag* own;
  const Real* fence;  // rows of 8: lowest x y z, L, highest x y z, a pad  [m]

  CDEM_HD bool operator()(One node) const {
    if (!own[node.i]) return false;
    const Real* box = fence + 8 * std::size_t(node.i);
    const PredictNodes& predict = paths.predict;
    const Vec3<Real> now = predict.rigid.nodes.position(node.i), v = predict.rigid.at(node.i);
    const Vec3<Real> then = now + predict.lookahead_time * v;
    const Real skin = paths.skin(node.i, v, box[3]);
    return is_outside(box, now, skin) || is_outside(box, then, skin);
  }

 private:
  CDEM_HD static bool is_outside(const Real* box, const Vec3<Real>& x, Real skin) {
    return x.x - skin < box[0] || x.y - skin < box[1] || x.z - skin < box[2] ||
           x.x + skin > box[4] || x.y + skin > box[5] || x.z + skin > box[6];
  }
};

}  // namespace cdem
