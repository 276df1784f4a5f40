// candidates.cpp - the lists of the search, by face, vertex and node.
#include "core/candidates.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
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
  Unset<T> items;
  T* begin(Index x) { return items.data() + first[x]; }
  T* end(Index x) { return items.data() + first[x + 1]; }
  const T* begin(Index x) const { return items.data() + first[x]; }
  const T* end(Index x) const { return items.data() + first[x + 1]; }
};

/// Counts that several threads may raise: where a row's next item goes. Which of them comes first
/// is left to chance, so rows must be sorted.
struct Counters {
  Index* counts;
  bool alone = omp_get_max_threads() == 1;  // taking turns costs time
  Index raise(std::size_t i) const {
    if (alone) return counts[i]++;
    return std::atomic_ref(counts[i]).fetch_add(1, std::memory_order_relaxed);
  }
};

/// Make starts of rows of counts: counts[i + 1] were those of row i.
template <class Counts>
void add_up(Counts& counts, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) counts[i + 1] += counts[i];
}

/// Deal out what was found to the mother faces; rows are sorted by `key`.
template <class T, class Key>
Rows<T> by_mother(const AllProximity& found, std::vector<T> Proximity::* list, Index count,
                  const Key& key) {
  Rows<T> rows;
  rows.first.resize(count + 1);
  const auto visit = [&](auto&& at) {
    for (const Proximity& of : found.by_thread) {
      const std::vector<T>& items = of.*list;
#pragma omp parallel for schedule(static) if (items.size() >= worth_threads)
      for (std::size_t i = 0; i < items.size(); ++i) at(items[i]);
    }
  };
  const Counters number{rows.first.data() + 1};
  visit([&](const T& item) { number.raise(item.mother); });
  add_up(rows.first, count);
  rows.items.resize(rows.first[count]);
  std::vector<Index> places(rows.first.begin(), rows.first.end() - 1);
  const Counters next{places.data()};
  visit([&](const T& item) { rows.items[next.raise(item.mother)] = item; });
#pragma omp parallel for schedule(dynamic, 64) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x)
    std::sort(rows.begin(x), rows.end(x), [&](const T& a, const T& b) { return key(a) < key(b); });
  return rows;
}

using Touches = Rows<Proximity::Touch>;
using Crossings = Rows<Proximity::Crossing>;

/// List the pairs that have been found, patch after patch, with their nodes and room, and let the
/// items that are of them know their places there.
template <class Pair, class Item>
void list_pairs(AllProximity& found, std::vector<Pair> Proximity::* pairs,
                Range AllProximity::Share::* pair_range, std::vector<Item> Proximity::* items,
                Range AllProximity::Share::* item_range, Column<Index>& nodes, Column<float>& room,
                Column<Flag>& near) {
  const std::size_t patches = found.by_patch.size();
  std::vector<Index> first(patches + 1);
  for (std::size_t p = 0; p < patches; ++p) {
    const Range range = found.by_patch[p].*pair_range;
    first[p + 1] = first[p] + range.last - range.first;
  }
  const Index count = first.back();
  const std::size_t stride = padded_stride(count);
  near.resize(count);
  nodes.resize(std::size(Pair{}.nodes) * stride);
  room.resize(std::size(Pair{}.room) * stride);
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
  for (std::size_t p = 0; p < patches; ++p) {
    const AllProximity::Share& share = found.by_patch[p];
    Proximity& lists = found.by_thread[share.thread];
    const Range of_pairs = share.*pair_range, of_items = share.*item_range;
    for (Index i = of_items.first; i < of_items.last; ++i)
      (lists.*items)[i].pair += first[p] - of_pairs.first;
    std::size_t place = first[p];
    for (Index i = of_pairs.first; i < of_pairs.last; ++i, ++place) {
      const Pair& pair = (lists.*pairs)[i];
      for (std::size_t k = 0; k < std::size(pair.nodes); ++k)
        nodes[k * stride + place] = pair.nodes[k];
      for (std::size_t k = 0; k < std::size(pair.room); ++k)
        room[k * stride + place] = float(pair.room[k]);
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
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
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
  const Counters number{first.data() + 1};
  visit([&](Index y, Index) { number.raise(y); });
  add_up(first, count);
  source.resize(first[count]);
  std::vector<Index> places(first.data(), first.data() + count);
  const Counters next{places.data()};
  visit([&](Index y, Index x) { source[next.raise(y)] = x; });
  if (next.alone) return;  // they are in ascending order
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
  for (Index y = 0; y < count; ++y)
    std::sort(source.data() + first[y], source.data() + first[y + 1]);
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
  add_up(first, 4 * std::size_t(count));
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
  using Share = AllProximity::Share;
  AllProximity found = find_proximity(m, s);
  list_pairs(found, &Proximity::faces, &Share::faces, &Proximity::touches, &Share::touches,
             s.search.faces_corners, s.search.faces_bounds, s.search.faces_near);
  list_pairs(found, &Proximity::edges, &Share::edges, &Proximity::crossings, &Share::crossings,
             s.search.edges_ends, s.search.edges_bounds, s.search.edges_near);
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
