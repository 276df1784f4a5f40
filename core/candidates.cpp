// candidates.cpp - the lists of the search, by face, vertex and node.
#include "core/candidates.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <vector>

#include "core/columns.hpp"
#include "core/exposed.hpp"
#include "core/proximity.hpp"

namespace cdem {

namespace {

/// Ragged rows, one for each exposed face.
template <class T>
struct Rows {
  std::vector<Index> first;
  std::vector<T> items;
  T* begin(Index x) { return items.data() + first[x]; }
  T* end(Index x) { return items.data() + first[x + 1]; }
  const T* begin(Index x) const { return items.data() + first[x]; }
  const T* end(Index x) const { return items.data() + first[x + 1]; }
};

/// Deal out what was found, `list` of each patch, to the mother faces; rows are sorted by `key`.
template <class T, class Key>
Rows<T> by_mother(const std::vector<Proximity>& found, std::vector<T> Proximity::* list,
                  Index count, const Key& key) {
  Rows<T> rows;
  rows.first.resize(count + 1);
  for (const Proximity& f : found)
    for (const T& item : f.*list) ++rows.first[item.mother + 1];
  for (Index x = 0; x < count; ++x) rows.first[x + 1] += rows.first[x];
  rows.items.resize(rows.first[count]);
  std::vector<Index> next(rows.first.begin(), rows.first.end() - 1);
  for (const Proximity& f : found)
    for (const T& item : f.*list) rows.items[next[item.mother]++] = item;
#pragma omp parallel for schedule(dynamic, 64) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x)
    std::sort(rows.begin(x), rows.end(x), [&](const T& a, const T& b) { return key(a) < key(b); });
  return rows;
}

using Touches = Rows<Proximity::Touch>;
using Crossings = Rows<Proximity::Crossing>;

/// List the pairs that all patches have found, with their nodes and room, and let the items that
/// are of them know their places there.
template <class Pair, class Item>
void list_pairs(std::vector<Proximity>& found, std::vector<Pair> Proximity::* pairs,
                std::vector<Item> Proximity::* items, Column<Index>& nodes, Column<float>& room,
                Column<Flag>& near) {
  std::vector<Index> first(found.size() + 1);
  for (std::size_t p = 0; p < found.size(); ++p)
    first[p + 1] = first[p] + Index((found[p].*pairs).size());
  const Index count = first.back();
  const std::size_t stride = padded_stride(count);
  near.resize(count);
  nodes.resize(std::size(Pair{}.nodes) * stride);
  room.resize(std::size(Pair{}.room) * stride);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (std::size_t p = 0; p < found.size(); ++p) {
    for (Item& item : found[p].*items) item.pair += first[p];
    std::size_t place = first[p];
    for (const Pair& pair : found[p].*pairs) {
      for (std::size_t k = 0; k < std::size(pair.nodes); ++k)
        nodes[k * stride + place] = pair.nodes[k];
      for (std::size_t k = 0; k < std::size(pair.room); ++k)
        room[k * stride + place] = float(pair.room[k]);
      ++place;
    }
  }
}

/// For every exposed face the others that list it: their contacts may act on it.
void list_sources(SearchState& search, const Touches& touches, const Crossings& crossings) {
  const Index count = Index(touches.first.size()) - 1;
  Column<Index>&first = search.source_first, &source = search.source;
  first.resize(count + 1);
  first.fill(0);
  const auto visit = [&](auto&& at) {
    for (Index x = 0; x < count; ++x) {
      const Proximity::Touch* touch = touches.begin(x);
      const Proximity::Crossing* crossing = crossings.begin(x);
      while (touch != touches.end(x) || crossing != crossings.end(x)) {
        // both are in ascending order
        const Index y = touch == touches.end(x)        ? crossing->face
                        : crossing == crossings.end(x) ? touch->face
                                                       : std::min(touch->face, crossing->face);
        at(y, x);
        while (touch != touches.end(x) && touch->face == y) ++touch;
        while (crossing != crossings.end(x) && crossing->face == y) ++crossing;
      }
    }
  };
  visit([&](Index y, Index) { ++first[y + 1]; });
  for (Index y = 0; y < count; ++y) first[y + 1] += first[y];
  source.resize(first[count]);
  std::vector<Index> next(first.data(), first.data() + count);
  visit([&](Index y, Index x) { source[next[y]++] = x; });
}

void list_touches(SearchState& search, const Touches& touches) {
  const Index count = Index(touches.first.size()) - 1;
  Column<Index>&first = search.candidate_first, &other = search.candidate;
  first.resize(4 * std::size_t(count) + 1);
  first.fill(0);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x)
    for (const Proximity::Touch* t = touches.begin(x); t != touches.end(x); ++t)
      ++first[4 * std::size_t(x) + t->vertex + 1];
  for (std::size_t slot = 0; slot < 4 * std::size_t(count); ++slot) first[slot + 1] += first[slot];
  other.resize(first[4 * std::size_t(count)]);
  search.candidate_pair.resize(other.size());
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x)
    for (Index k = 0; k < 4; ++k) {
      Index place = first[4 * x + k];
      for (const Proximity::Touch* t = touches.begin(x); t != touches.end(x); ++t)
        if (t->vertex == k) {
          search.candidate_pair[place] = t->pair;
          other[place++] = t->face;
        }
    }
}

void list_crossings(const Model& m, SearchState& search, const Crossings& crossings) {
  search.edge_candidate_first.assign(crossings.first.data(), crossings.first.size());
  const std::size_t count = crossings.items.size();
  search.edge_candidate.resize(count);
  search.edge_candidate_edge.resize(count);
  search.edge_candidate_sides.resize(count);
  search.edge_candidate_edges.resize(count);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (std::size_t i = 0; i < count; ++i) {
    const Proximity::Crossing& c = crossings.items[i];
    search.edge_candidate[i] = c.face;
    search.edge_candidate_edge[i] =
        m.face_edges[4 * search.exposed_face[c.face] + SidePair::of(c.sides).j];
    search.edge_candidate_sides[i] = c.sides;
    search.edge_candidate_edges[i] = c.pair;
  }
}

}  // namespace

void list_candidates(const Model& m, State& s) {
  foresee_motion(m, s);
  std::vector<Proximity> found = find_proximity(m, s);
  list_pairs(found, &Proximity::faces, &Proximity::touches, s.search.faces_corners,
             s.search.faces_bounds, s.search.faces_near);
  list_pairs(found, &Proximity::edges, &Proximity::crossings, s.search.edges_ends,
             s.search.edges_bounds, s.search.edges_near);
  const Index count = Index(s.search.exposed_face.size());
  const Touches touches =
      by_mother(found, &Proximity::touches, count,
                [](const Proximity::Touch& t) { return std::pair(t.face, t.vertex); });
  const Crossings crossings =
      by_mother(found, &Proximity::crossings, count, [](const Proximity::Crossing& c) {
        const SidePair pair = SidePair::of(c.sides);
        return std::tuple(c.face, pair.k, pair.j);
      });
  list_touches(s.search, touches);
  list_crossings(m, s.search, crossings);
  list_sources(s.search, touches, crossings);
}

void list_corners(const Model& m, State& s) {
  std::vector<Flag> released(m.corner_rows);
  const auto mark = [&](const PairSet& p, const PairState& ps) {
    for (Index i = 0; i < p.count; ++i)
      if (!(ps.live[i] > 0))
        std::fill_n(released.begin() + p.corner_first + i * p.corners, p.corners, Flag(1));
  };
  mark(m.triangles, s.triangles);
  mark(m.quads, s.quads);
  mark(m.overlaps, s.overlaps);
  Column<Index>&first = s.nodes.corner_first, &corner = s.nodes.corner;
  first.resize(m.node_count + 1);
  corner.resize(0);
  first[0] = 0;
  for (Index i = 0; i < m.node_count; ++i) {
    for (Index c = m.corner_first[i]; c < m.corner_first[i + 1]; ++c)
      if (!released[m.corner[c] < 0 ? ~m.corner[c] : m.corner[c]]) corner.push(m.corner[c]);
    first[i + 1] = Index(corner.size());
  }
}

void list_contact_corners(const Model& m, State& s) {
  Column<Index>&first = s.search.contact_first, &corner = s.search.contact_corner;
  first.resize(m.node_count + 1);
  first.fill(0);
  const auto visit = [&](auto&& at) {
    for (Index x = 0; x < Index(s.search.exposed_face.size()); ++x) {
      if (is_idle(candidate_columns(s), edge_candidate_columns(s), source_columns(s), x)) continue;
      const Index face = s.search.exposed_face[x];
      for (Index k = 0; k < 4; ++k)
        if (m.face_nodes[4 * face + k] >= 0) at(m.face_nodes[4 * face + k], 4 * x + k);
    }
  };
  visit([&](Index node, Index) { ++first[node + 1]; });
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  corner.resize(first[m.node_count]);
  std::vector<Index> next(first.data(), first.data() + m.node_count);
  visit([&](Index node, Index row) { corner[next[node]++] = row; });
}

}  // namespace cdem
