// candidates.cpp - the lists of the search, by face, vertex and node.
#include "core/candidates.hpp"

#include <algorithm>
#include <tuple>
#include <vector>

#include "core/exposed.hpp"
#include "core/proximity.hpp"

namespace cdem {

namespace {

/// What one exposed face may touch before the next refresh.
struct Row {
  std::vector<Proximity::Touch> touches;
  std::vector<Proximity::Crossing> crossings;
};

std::vector<Row> rows_by_face(std::size_t count, const std::vector<Proximity>& found) {
  std::vector<Row> rows(count);
  Index edges = 0;  // of the patches before
  for (const Proximity& f : found) {
    for (const auto& t : f.touches) rows[t.mother].touches.push_back(t);
    for (auto c : f.crossings) {
      c.edges += edges;
      rows[c.mother].crossings.push_back(c);
    }
    edges += Index(f.edges.size());
  }
#pragma omp parallel for schedule(dynamic, 64) if (count >= worth_threads)
  for (std::size_t x = 0; x < count; ++x) {
    std::sort(rows[x].touches.begin(), rows[x].touches.end(),
              [](const auto& a, const auto& b) { return a.face < b.face; });
    const auto key = [](const Proximity::Crossing& c) {
      const SidePair pair = SidePair::of(c.sides);
      return std::tuple(c.face, pair.k, pair.j);
    };
    std::sort(rows[x].crossings.begin(), rows[x].crossings.end(),
              [&](const auto& a, const auto& b) { return key(a) < key(b); });
  }
  return rows;
}

void list_edges(SearchState& search, const std::vector<Proximity>& found) {
  Index count = 0;
  for (const Proximity& f : found) count += Index(f.edges.size());
  const std::size_t stride = padded_stride(count);
  search.edges_near.resize(count);
  search.edges_ends.resize(4 * stride);
  search.edges_room.resize(3 * stride);
  std::size_t place = 0;
  for (const Proximity& f : found)
    for (const Proximity::Edges& e : f.edges) {
      for (std::size_t k = 0; k < 4; ++k) search.edges_ends[k * stride + place] = e.ends[k];
      for (std::size_t k = 0; k < 3; ++k) search.edges_room[k * stride + place] = e.room[k];
      ++place;
    }
}

/// For every exposed face the others that list it: their contacts may act on it.
void list_sources(State& s, const std::vector<Row>& rows) {
  const Index count = Index(rows.size());
  Column<Index>&first = s.search.source_first, &source = s.search.source;
  first.resize(count + 1);
  first.fill(0);
  const auto visit = [&](auto&& at) {
    for (Index x = 0; x < count; ++x) {
      auto touch = rows[x].touches.begin();
      auto crossing = rows[x].crossings.begin();
      while (touch != rows[x].touches.end() || crossing != rows[x].crossings.end()) {
        // both are in ascending order
        const Index y = touch == rows[x].touches.end() ? crossing->face
                        : crossing == rows[x].crossings.end()
                            ? touch->face
                            : std::min(touch->face, crossing->face);
        at(y, x);
        while (touch != rows[x].touches.end() && touch->face == y) ++touch;
        while (crossing != rows[x].crossings.end() && crossing->face == y) ++crossing;
      }
    }
  };
  visit([&](Index y, Index) { ++first[y + 1]; });
  for (Index y = 0; y < count; ++y) first[y + 1] += first[y];
  source.resize(first[count]);
  std::vector<Index> next(first.data(), first.data() + count);
  visit([&](Index y, Index x) { source[next[y]++] = x; });
}

}  // namespace

void list_candidates(const Model& m, State& s) {
  foresee_motion(m, s);
  const std::vector<Proximity> found = find_proximity(m, s);
  list_edges(s.search, found);
  const std::vector<Row> rows = rows_by_face(s.search.exposed_face.size(), found);
  const Index count = Index(rows.size());
  Column<Index>&first = s.search.candidate_first, &other = s.search.candidate;
  Column<Index>& crossing_first = s.search.edge_candidate_first;
  first.resize(4 * std::size_t(count) + 1);
  crossing_first.resize(count + 1);
  first[0] = crossing_first[0] = 0;
  for (Index x = 0; x < count; ++x) {
    Index touching[4] = {};
    for (const Proximity::Touch& t : rows[x].touches)
      for (Index k = 0; k < 4; ++k) touching[k] += t.vertices >> k & 1;
    for (Index k = 0; k < 4; ++k) first[4 * x + k + 1] = first[4 * x + k] + touching[k];
    crossing_first[x + 1] = crossing_first[x] + Index(rows[x].crossings.size());
  }
  other.resize(first[4 * std::size_t(count)]);
  s.search.edge_candidate.resize(crossing_first[count]);
  s.search.edge_candidate_sides.resize(crossing_first[count]);
  s.search.edge_candidate_edges.resize(crossing_first[count]);
  for (Index x = 0; x < count; ++x) {
    for (Index k = 0; k < 4; ++k) {
      Index place = first[4 * x + k];
      for (const Proximity::Touch& t : rows[x].touches)
        if (t.vertices >> k & 1) other[place++] = t.face;
    }
    Index place = crossing_first[x];
    for (const Proximity::Crossing& c : rows[x].crossings) {
      s.search.edge_candidate[place] = c.face;
      s.search.edge_candidate_edges[place] = c.edges;
      s.search.edge_candidate_sides[place++] = c.sides;
    }
  }
  list_sources(s, rows);
}

void list_contact_corners(const Model& m, State& s) {
  Column<Index>&first = s.search.contact_first, &corner = s.search.contact_corner;
  first.resize(m.node_count + 1);
  first.fill(0);
  const auto visit = [&](auto&& at) {
    for (std::size_t x = 0; x < s.search.exposed_face.size(); ++x) {
      const Index face = s.search.exposed_face[x];
      for (Index k = 0; k < 4; ++k)
        if (m.face_nodes[4 * face + k] >= 0) at(m.face_nodes[4 * face + k], Index(4 * x) + k);
    }
  };
  visit([&](Index node, Index) { ++first[node + 1]; });
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  corner.resize(first[m.node_count]);
  std::vector<Index> next(first.data(), first.data() + m.node_count);
  visit([&](Index node, Index row) { corner[next[node]++] = row; });
}

}  // namespace cdem
