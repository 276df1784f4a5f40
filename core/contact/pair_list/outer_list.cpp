// outer_list.cpp - see outer_list.hpp.
#include "core/contact/pair_list/outer_list.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/contact/broad_phase/pair_search.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"

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
  bool alone = runs_alone();
  Index raise(std::size_t i) const { return cdem::raise(counts[i], alone); }
};

/// Make starts of rows of counts: counts[i + 1] were those of row i.
template <class Counts>
void add_up(Counts& counts, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) counts[i + 1] += counts[i];
}

/// Sort the items found by mother face; within a face by `key`.
template <class T, class Key>
Rows<T> by_mother(const PairBuffers& found, std::vector<T> PairBuffer::* list, Index count,
                  const Key& key) {
  Rows<T> rows;
  rows.first.resize(count + 1);
  const auto visit = [&](auto&& at) {
    for (const PairBuffer& of : found.by_thread) {
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

using CandidateRows = Rows<PairBuffer::Candidate>;
using Share = PairBuffers::Share;

/// Where the pairs of each patch begin in the list of all.
std::vector<Index> places(const PairBuffers& found, Range Share::* share) {
  std::vector<Index> first(found.by_patch.size() + 1);
  for (std::size_t p = 0; p < found.by_patch.size(); ++p)
    first[p + 1] = first[p] + (found.by_patch[p].*share).last - (found.by_patch[p].*share).first;
  return first;
}

/// List the pairs found, patch after patch, with their members and room; `also` gets every pair and
/// its place.
template <class Pair, class Also>
void list_pairs(const PairBuffers& found, std::vector<Pair> PairBuffer::* pairs,
                Range Share::* share, const std::vector<Index>& first, Column<Index>& of,
                Column<float>& room, const Also& also) {
  const Index patches = Index(found.by_patch.size()), count = first.back();
  const std::size_t stride = padded_stride(count);
  of.resize(2 * stride);
  room.resize(std::size(Pair{}.room) * stride);
  const auto members = on_host(of);
  const auto rooms = on_host(room);
  for (std::size_t k = 0; k < 2; ++k)  // lanes go on past the last
    std::fill(members.begin() + k * stride + count, members.begin() + (k + 1) * stride, 0);
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
  for (Index p = 0; p < patches; ++p) {
    const std::vector<Pair>& list = found.by_thread[found.by_patch[p].thread].*pairs;
    const Range range = found.by_patch[p].*share;
    std::size_t place = first[p];
    for (Index i = range.first; i < range.last; ++i, ++place) {
      const Pair& pair = list[i];
      for (std::size_t k = 0; k < 2; ++k) members[k * stride + place] = pair.of[k];
      for (std::size_t k = 0; k < std::size(pair.room); ++k)
        rooms[k * stride + place] = float(pair.room[k]);
      also(pair, place);
    }
  }
}

/// List the pairs of vertex and face; candidates get the places of their pairs.
void list_face_pairs(PairBuffers& found, SearchState& search) {
  const std::vector<Index> first = places(found, &Share::vertex_faces);
  list_pairs(found, &PairBuffer::vertex_faces, &Share::vertex_faces, first, search.outer.vf_pairs,
             search.outer.vf_bounds, [](const auto&, std::size_t) {});
  const Index patches = Index(found.by_patch.size());
#pragma omp parallel for schedule(static, 128) if (first.back() >= worth_threads)
  for (Index p = 0; p < patches; ++p) {
    const Share& share = found.by_patch[p];
    std::vector<PairBuffer::Candidate>& candidates = found.by_thread[share.thread].candidates;
    for (Index i = share.candidates.first; i < share.candidates.last; ++i)
      candidates[i].pair += first[p] - share.vertex_faces.first;
  }
}

/// List the pairs of edges.
void list_edge_pairs(const PairBuffers& found, SearchState& search) {
  const std::vector<Index> first = places(found, &Share::edges);
  search.outer.ee_sides.assign(found.edge_sides.data(), found.edge_sides.size());
  search.outer.ee_codes.renew(first.back());
  const auto codes = on_host(search.outer.ee_codes);
  list_pairs(found, &PairBuffer::edges, &Share::edges, first, search.outer.ee_pairs,
             search.outer.ee_bounds, [&](const PairBuffer::EdgePair& pair, std::size_t place) {
               codes[place] = pair.code;
             });
}

/// For every edge of the mesh the pairs that it is of, and the other edges.
void list_pairs_of_edges(const Model& m, SearchState& search) {
  const Index count = Index(search.outer.ee_codes.size());
  const std::size_t stride = padded_stride(count);
  search.outer.edge_first.resize(0);
  search.outer.edge_pairs.renew(4 * std::size_t(count));
  if (count == 0) return;
  std::vector<Index> first(m.edge_nodes.size() / 2 + 1);
  const auto sides = on_host(search.outer.ee_sides), members = on_host(search.outer.ee_pairs);
  const auto exposed_face = on_host(search.exposed_face), pairs = on_host(search.outer.edge_pairs);
  const auto face_edges = on_host(m.face_edges);
  const auto edge = [&](Index p, Index which) {
    const Index side = sides[2 * std::size_t(members[which * stride + p])];
    return face_edges[4 * exposed_face[side / 4] + side % 4];
  };
  for (Index p = 0; p < count; ++p)
    for (const Index which : {0, 1}) ++first[edge(p, which) + 1];
  add_up(first, first.size() - 1);
  search.outer.edge_first.assign(first);
  for (Index p = 0; p < count; ++p)
    for (const Index which : {0, 1}) {
      const std::size_t place = first[edge(p, which)]++;
      pairs[2 * place] = p;
      pairs[2 * place + 1] = edge(p, 1 - which);
    }
}

/// For every exposed face the others that list it: their contacts may act on it.
void list_sources(const PairBuffers& found, Index count, SearchState& search) {
  std::vector<Index> first(count + 1);
  std::vector<Flag> listed(count);
  const auto visit = [&](auto&& at) {
    for (const PairBuffer& of : found.by_thread) {
#pragma omp parallel for schedule(static) if (of.face_pairs.size() >= worth_threads)
      for (std::size_t i = 0; i < of.face_pairs.size(); ++i) at(of.face_pairs[i]);
    }
  };
  const Counters number{first.data() + 1};
  visit([&](const PairBuffer::FacePair& pair) {
    number.raise(pair.face);
    set(listed[pair.face]);
    set(listed[pair.mother]);
  });
  add_up(first, count);
  search.outer.face_listed.assign(listed);
  search.outer.acting_first.assign(first);
  search.outer.faces_acting_on.renew(first[count]);
  const auto source = on_host(search.outer.faces_acting_on);
  std::vector<Index> places(first.begin(), first.end() - 1);
  const Counters next{places.data()};
  visit([&](const PairBuffer::FacePair& pair) { source[next.raise(pair.face)] = pair.mother; });
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
  for (Index y = 0; y < count; ++y)
    std::sort(source.begin() + first[y], source.begin() + first[y + 1]);
}

void list_slot_candidates(SearchState& search, const CandidateRows& candidates) {
  const Index count = Index(candidates.first.size()) - 1;
  std::vector<Index> first(4 * std::size_t(count) + 1);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x)
    for (const PairBuffer::Candidate* t = candidates.begin(x); t != candidates.end(x); ++t)
      ++first[4 * std::size_t(x) + t->vertex + 1];
  add_up(first, 4 * std::size_t(count));
  search.outer.slot_first.assign(first);
  search.outer.slot_faces.renew(first.back());
  search.outer.slot_pairs.renew(first.back());
  const auto other = on_host(search.outer.slot_faces), pair = on_host(search.outer.slot_pairs);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index x = 0; x < count; ++x)
    for (Index k = 0; k < 4; ++k) {
      Index place = first[4 * x + k];
      for (const PairBuffer::Candidate* t = candidates.begin(x); t != candidates.end(x); ++t)
        if (t->vertex == k) {
          pair[place] = t->pair;
          other[place++] = t->face;
        }
    }
}

}  // namespace

void list_candidates(const Model& m, State& s) {
  predict_motion(m, s);
  if (!s.search.lists) s.search.lists = std::make_shared<PairSearch>();
  search_pairs(m, s, *s.search.lists);
  PairBuffers& found = s.search.lists->found;
  const Index count = Index(s.search.exposed_face.size());
  list_face_pairs(found, s.search);
  list_edge_pairs(found, s.search);
  list_pairs_of_edges(m, s.search);
  s.search.outer.rotation_soon.renew(count);
  const auto rotation_soon = on_host(s.search.outer.rotation_soon);
  for (Index x = 0; x < count; ++x) rotation_soon[x] = s.search.lists->exposed[x].rotation_soon;
  s.search.inner.known = false;
  list_sources(found, count, s.search);
  list_slot_candidates(s.search, by_mother(found, &PairBuffer::candidates, count,
                                           [](const PairBuffer::Candidate& t) {
                                             return std::pair(t.face, t.vertex);
                                           }));
}

}  // namespace cdem
