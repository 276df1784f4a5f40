// bonded_surface.cpp - see bonded_surface.hpp.
#include "core/bonds/bonded_surface.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include "core/base/exact_sum.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Visit the conforming pairs that are still live.
template <class Visit>
void for_live_pairs(const Model& m, const State& s, Visit&& visit) {
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    for (Index i = 0; conforms(p) && i < p.count; ++i)
      if (is_active(ps, i)) visit(p, ps, i);
  });
}

/// Joins items; each part has the number of its first item as label.
class Parts {
 public:
  explicit Parts(Column<Index>& labels, Index count) : label_(labels.data()), count_(count) {
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
  for_live_pairs(m, s, [&](const PairSet& p, const PairState& ps, Index i) {
    for (Index k = 0; k < p.points; ++k)
      if (ps.bond[std::size_t(k) * p.point_stride + i] > 0)
        parts.join(p.nodes[std::size_t(k) * p.stride + i],
                   p.nodes[std::size_t(p.points + k) * p.stride + i]);
  });
  parts.finish();
}

/// Label the nodes of blocks that any live pair joins.
void join_bodies(const Model& m, State& s) {
  Parts parts(s.nodes.body, m.node_count);
  for (Index i = 1; i < m.node_count; ++i)
    if (m.node_block[i] == m.node_block[i - 1]) parts.join(i - 1, i);
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    for (Index i = 0; i < p.count; ++i)
      if (is_active(ps, i))
        parts.join(m.face_nodes[4 * p.faces[2 * i]], m.face_nodes[4 * p.faces[2 * i + 1]]);
  });
  parts.finish();
}

/// Edge stars of the points that vertices of exposed faces belong to: other ends of all edges that
/// leave any node of the point, once each, and by a node of an exposed face if there is one.
void merge_edge_stars(const Model& m, State& s) {
  const Index* bonded_node = s.nodes.bonded_node.data();
  std::vector<Flag> exposed(m.node_count);
  for (std::size_t x = 0; x < s.search.exposed_face.size(); ++x)
    for (Index k = 0; k < 4; ++k) {
      const Index node = m.face_nodes[4 * s.search.exposed_face[x] + k];
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

  s.search.edge_star_first.resize(m.node_count + 1);
  s.search.edge_star.resize(0);
  std::vector<std::tuple<Index, bool, Index>> ends;  // label, not exposed, node
  for (Index label = 0; label < m.node_count; ++label) {
    s.search.edge_star_first[label] = Index(s.search.edge_star.size());
    if (!wanted[label]) continue;
    ends.clear();
    for (Index c = first[label]; c < first[label + 1]; ++c)
      for (Index r = m.edge_star_first[member[c]]; r < m.edge_star_first[member[c] + 1]; ++r)
        ends.push_back({bonded_node[m.edge_star[r]], !exposed[m.edge_star[r]], m.edge_star[r]});
    std::sort(ends.begin(), ends.end());
    Index last = -1;
    for (const auto& [end, hidden, node] : ends)
      if (end != last) s.search.edge_star.push(node), last = end;
  }
  s.search.edge_star_first[m.node_count] = Index(s.search.edge_star.size());
}

/// The face beyond a side of an exposed face: walk through the bodies that meet there, from each
/// into the next that is bonded to it along the side, until a face is in the open.
void find_across(const Model& m, State& s) {
  const Index* bonded_node = s.nodes.bonded_node.data();
  std::vector<Index> mate(m.face_count, -1);
  for_live_pairs(m, s, [&](const PairSet& p, const PairState&, Index i) {
    mate[p.faces[2 * i]] = p.faces[2 * i + 1];
    mate[p.faces[2 * i + 1]] = p.faces[2 * i];
  });
  const auto vertices = [&](Index face) { return m.face_nodes[4 * face + 3] < 0 ? 3 : 4; };
  // side of a face between the same two points as an edge, or -1
  const auto side_along = [&](Index face, Index edge) {
    const Index a = bonded_node[m.edge_nodes[2 * edge]],
                b = bonded_node[m.edge_nodes[2 * edge + 1]];
    const Index count = vertices(face);
    for (Index k = 0; k < count; ++k) {
      const Index u = bonded_node[m.face_nodes[4 * face + k]];
      const Index v = bonded_node[m.face_nodes[4 * face + (k + 1) % count]];
      if ((u == a && v == b) || (u == b && v == a)) return k;
    }
    return Index(-1);
  };
  constexpr Index most_bodies = 1000;  // around one edge
  const Index count = Index(s.search.exposed_face.size());
  s.search.across.resize(4 * std::size_t(count), -1);
  for (Index x = 0; x < count; ++x)
    for (Index k = 0; k < vertices(s.search.exposed_face[x]); ++k) {
      Index face = s.search.exposed_face[x], side = k, beyond = -1;
      for (Index body = 0; body < most_bodies; ++body) {
        const Index edge = m.face_edges[4 * face + side];
        const Index a = m.edge_faces[2 * edge], b = m.edge_faces[2 * edge + 1];
        beyond = a == face ? b : a;
        if (beyond < 0 || s.search.face_exposed[beyond] >= 0 || mate[beyond] < 0) break;
        face = mate[beyond];
        side = side_along(face, edge);
        if (side < 0) break;  // the bond is broken there
      }
      s.search.across[4 * std::size_t(x) + k] = beyond;
    }
}

/// How many bond points of conforming pairs are intact.
Real bonded_points(const Model& m, const State& s) {
  Real sum = 0;
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    if (conforms(p)) sum += exact_sum(Index(ps.bond.size()), [&](Index i) { return ps.bond[i]; });
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
