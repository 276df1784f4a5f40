// bonded_surface.cpp - see bonded_surface.hpp.
#include "core/bonds/bonded_surface.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include "core/base/primitives.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Call visit(set, its state, pairs) for the sets of conforming pairs, and those that are live.
template <class Visit>
void for_live_pairs(const Model& m, const State& s, Visit&& visit) {
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    if (!conforms(p)) return;
    const auto is_active = activity(ps);
    std::vector<Index> live;
    for (Index i = 0; i < p.count; ++i)
      if (is_active(i)) live.push_back(i);
    visit(p, ps, live);
  });
}

/// Joins items; each part has the number of its first item as label.
class Parts {
 public:
  explicit Parts(Column<Index>& labels, Index count)
      : label_(on_host(labels).data()), count_(count) {
    std::iota(label_, label_ + count_, 0);
  }
  void join(Index i, Index j) {
    const Index a = root(i), b = root(j);
    label_[std::max(a, b)] = std::min(a, b);
  }
  void finish() {
    for (Index i = 0; i < count_; ++i) label_[i] = root(i);
  }

 private:
  Index root(Index i) {
    while (label_[i] != i) i = label_[i] = label_[label_[i]];
    return i;
  }
  Index* label_;
  Index count_;
};

void join_nodes(const Model& m, State& s) {
  Parts parts(s.nodes.bonded_node, m.node_count);
  for_live_pairs(m, s, [&](const PairSet& p, const PairState& ps, const std::vector<Index>& live) {
    const auto nodes = on_host(p.nodes);
    const auto bond = on_host(ps.bond);
    for (const Index i : live)
      for (Index k = 0; k < p.points; ++k)
        if (bond[std::size_t(k) * p.point_stride + i] > 0)
          parts.join(nodes[std::size_t(k) * p.stride + i],
                     nodes[std::size_t(p.points + k) * p.stride + i]);
  });
  parts.finish();
}

/// Label the nodes of blocks that any live pair joins.
void join_bodies(const Model& m, State& s) {
  Parts parts(s.nodes.body, m.node_count);
  const auto block = on_host(m.node_block), face_nodes = on_host(m.face_nodes);
  for (Index i = 1; i < m.node_count; ++i)
    if (block[i] == block[i - 1]) parts.join(i - 1, i);
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    const auto is_active = activity(ps);
    const auto faces = on_host(p.faces);
    for (Index i = 0; i < p.count; ++i)
      if (is_active(i)) parts.join(face_nodes[4 * faces[2 * i]], face_nodes[4 * faces[2 * i + 1]]);
  });
  parts.finish();
}

/// Edge stars of the points that vertices of exposed faces belong to: other ends of all edges that
/// leave any node of the point, once each, and by a node of an exposed face if there is one.
void merge_edge_stars(const Model& m, State& s) {
  const auto bonded_node = on_host(s.nodes.bonded_node);
  const auto face_nodes = on_host(m.face_nodes);
  std::vector<Flag> exposed(m.node_count);
  for (const Index face : on_host(s.search.exposed_face))
    for (Index k = 0; k < 4; ++k) {
      const Index node = face_nodes[4 * face + k];
      if (node >= 0) exposed[node] = 1;
    }
  std::vector<Flag> wanted(m.node_count);  // by label
  for (Index i = 0; i < m.node_count; ++i)
    if (exposed[i]) wanted[bonded_node[i]] = 1;

  std::vector<Index> first(m.node_count + 1), member(m.node_count);
  for (Index i = 0; i < m.node_count; ++i) ++first[bonded_node[i] + 1];
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  std::vector<Index> next(first.begin(), first.end() - 1);
  for (Index i = 0; i < m.node_count; ++i) member[next[bonded_node[i]]++] = i;

  const auto own_first = on_host(m.edge_star_first), own = on_host(m.edge_star);
  std::vector<Index> star_first(m.node_count + 1), star;
  std::vector<std::tuple<Index, bool, Index>> ends;  // label, not exposed, node
  for (Index label = 0; label < m.node_count; ++label) {
    star_first[label] = Index(star.size());
    if (!wanted[label]) continue;
    ends.clear();
    for (Index c = first[label]; c < first[label + 1]; ++c)
      for (Index r = own_first[member[c]]; r < own_first[member[c] + 1]; ++r)
        ends.push_back({bonded_node[own[r]], !exposed[own[r]], own[r]});
    std::sort(ends.begin(), ends.end());
    Index last = -1;
    for (const auto& [end, hidden, node] : ends)
      if (end != last) star.push_back(node), last = end;
  }
  star_first[m.node_count] = Index(star.size());
  s.search.edge_star_first.assign(star_first);
  s.search.edge_star.assign(star);
}

/// The face that each is bonded to, or -1.
std::vector<Index> bonded_mates(const Model& m, const State& s) {
  std::vector<Index> mate(m.face_count, -1);
  for_live_pairs(m, s, [&](const PairSet& p, const PairState&, const std::vector<Index>& live) {
    const auto faces = on_host(p.faces);
    for (const Index i : live) {
      mate[faces[2 * i]] = faces[2 * i + 1];
      mate[faces[2 * i + 1]] = faces[2 * i];
    }
  });
  return mate;
}

/// The face beyond a side of an exposed face: walk through the bodies that meet there, from each
/// into the next that is bonded to it along the side, until a face is in the open.
void find_across(const Model& m, State& s) {
  const std::vector<Index> mate = bonded_mates(m, s);
  const auto bonded_node = on_host(s.nodes.bonded_node);
  const auto face_nodes = on_host(m.face_nodes), face_edges = on_host(m.face_edges);
  const auto edge_nodes = on_host(m.edge_nodes), edge_faces = on_host(m.edge_faces);
  const auto vertices = [&](Index face) { return face_nodes[4 * face + 3] < 0 ? 3 : 4; };
  // side of a face between the same two points as an edge, or -1
  const auto side_along = [&](Index face, Index edge) {
    const Index a = bonded_node[edge_nodes[2 * edge]], b = bonded_node[edge_nodes[2 * edge + 1]];
    const Index count = vertices(face);
    for (Index k = 0; k < count; ++k) {
      const Index u = bonded_node[face_nodes[4 * face + k]];
      const Index v = bonded_node[face_nodes[4 * face + (k + 1) % count]];
      if ((u == a && v == b) || (u == b && v == a)) return k;
    }
    return Index(-1);
  };
  constexpr Index most_bodies = 1000;  // around one edge
  const Index count = Index(s.search.exposed_face.size());
  s.search.across.resize(4 * std::size_t(count), -1);
  const auto exposed_face = on_host(s.search.exposed_face), place = on_host(s.search.face_exposed);
  const auto across = on_host(s.search.across);
  for (Index x = 0; x < count; ++x)
    for (Index k = 0; k < vertices(exposed_face[x]); ++k) {
      Index face = exposed_face[x], side = k, beyond = -1;
      for (Index body = 0; body < most_bodies; ++body) {
        const Index edge = face_edges[4 * face + side];
        const Index a = edge_faces[2 * edge], b = edge_faces[2 * edge + 1];
        beyond = a == face ? b : a;
        if (beyond < 0 || place[beyond] >= 0 || mate[beyond] < 0) break;
        face = mate[beyond];
        side = side_along(face, edge);
        if (side < 0) break;  // the bond is broken there
      }
      across[4 * std::size_t(x) + k] = beyond;
    }
}

/// How many bond points of conforming pairs are intact.
Real bonded_points(const Model& m, const State& s) {
  Real sum = 0;
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    if (conforms(p)) sum += column_sum({}, ps.bond);
  });
  return sum;
}

}  // namespace

void join_surfaces(const Model& m, State& s, bool released) {
  const Index faces = Index(s.search.exposed_face.size());
  const Real points = bonded_points(m, s);
  if (!released && faces == s.search.joined_faces && points == s.search.joined_points) return;
  s.search.joined_faces = faces;
  s.search.joined_points = points;
  join_nodes(m, s);
  join_bodies(m, s);
  merge_edge_stars(m, s);
  find_across(m, s);
}

}  // namespace cdem
