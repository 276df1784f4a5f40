// outer_list.cpp - see outer_list.hpp.
#include "core/contact/pair_list/outer_list.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/primitives.hpp"
#include "core/contact/broad_phase/pair_search.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/pair_list/views.hpp"

namespace cdem {

namespace {

/// Counts that several threads may raise: where a row's next item goes. Which of them comes first
/// is left to chance, so rows must be sorted.
struct Counters {
  Index* counts;
  bool alone = runs_alone();
  Index raise(std::size_t i) const { return cdem::raise(counts[i], alone); }
};

/// Turn counts into starts of rows: counts[i + 1] was the count of row i.
template <class Counts>
void add_up(Counts& counts, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) counts[i + 1] += counts[i];
}

/// Visit the results of a search, several items at once.
template <class T, class Visit>
void for_each_found(const PairBuffers& found, PartedList<T> PairBuffer::* list,
                    const Visit& visit) {
  for (const PairBuffer& of : found.by_thread) {
    const PartedList<T>& items = of.*list;
#pragma omp parallel for schedule(static) if (items.size() >= worth_threads)
    for (std::size_t i = 0; i < items.size(); ++i) visit(items[i]);
  }
}

/// Free the memory of listed results, for the next ones.
template <class T>
void drop(PairBuffers& found, PartedList<T> PairBuffer::* list) {
  for (PairBuffer& of : found.by_thread) of.*list = {};
}

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
void list_pairs(const PairBuffers& found, PartedList<Pair> PairBuffer::* pairs,
                Range Share::* share, const std::vector<Index>& first, Column<Index>& of,
                Column<float>& room, const Also& also) {
  const Index patches = Index(found.by_patch.size()), count = first.back();
  const std::size_t stride = padded_stride(count);
  of.renew(2 * stride);
  room.renew(std::size(Pair{}.room) * stride);
  const auto members = on_host(of);
  const auto rooms = on_host(room);
  for (std::size_t k = 0; k < 2; ++k)  // lanes go on past the last
    std::fill(members.begin() + k * stride + count, members.begin() + (k + 1) * stride, 0);
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
  for (Index p = 0; p < patches; ++p) {
    const PartedList<Pair>& list = found.by_thread[found.by_patch[p].thread].*pairs;
    const Range range = found.by_patch[p].*share;
    std::size_t place = first[p];
    for (Index i = range.first; i < range.last; ++i, ++place) {
      const Pair& pair = list[i];
      for (std::size_t k = 0; k < 2; ++k) members[k * stride + place] = pair.of[k];
      for (std::size_t k = 0; k < std::size(pair.room); ++k)
        rooms[k * stride + place] = pair.room[k];
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
    PartedList<PairBuffer::Candidate>& candidates = found.by_thread[share.thread].candidates;
    for (Index i = share.candidates.first; i < share.candidates.last; ++i)
      candidates[i].pair += first[p] - share.vertex_faces.first;
  }
  drop(found, &PairBuffer::vertex_faces);
}

/// List the pairs of edges.
void list_edge_pairs(PairBuffers& found, SearchState& search) {
  const std::vector<Index> first = places(found, &Share::edges);
  search.outer.ee_sides.assign(found.edge_sides.data(), found.edge_sides.size());
  search.outer.ee_codes.renew(first.back());
  const auto codes = on_host(search.outer.ee_codes);
  list_pairs(found, &PairBuffer::edges, &Share::edges, first, search.outer.ee_pairs,
             search.outer.ee_bounds, [&](const PairBuffer::EdgePair& pair, std::size_t place) {
               codes[place] = pair.code;
             });
  drop(found, &PairBuffer::edges);
}

/// For every edge of the mesh the pairs that it is of, with edges of higher numbers.
void list_pairs_of_edges(const Model& m, SearchState& search) {
  OuterList& outer = search.outer;
  const Index count = Index(outer.ee_codes.size());
  outer.edge_first.resize(0);
  outer.edge_others.renew(count);
  if (count == 0) return outer.edge_pairs.renew(0);
  const EdgesOfPairs edges = edges_of_pairs(m, search);
  list_rows({}, count, count, Index(m.edge_nodes.size() / 2), RowOfEdges{edges}, outer.edge_first,
            outer.edge_pairs);
  for_each_item({}, count, SetOtherEdge{edges, outer.edge_pairs.data(), outer.edge_others.data()});
}

/// For every exposed face the others that list it: their contacts may act on it.
void list_sources(PairBuffers& found, SearchState& search) {
  const Index count = Index(search.exposed_face.size());
  std::vector<Index> first(count + 1);
  std::vector<Flag> listed(count);
  const Counters number{first.data() + 1};
  for_each_found(found, &PairBuffer::face_pairs, [&](const PairBuffer::FacePair& pair) {
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
  for_each_found(found, &PairBuffer::face_pairs, [&](const PairBuffer::FacePair& pair) {
    source[next.raise(pair.face)] = pair.mother;
  });
  drop(found, &PairBuffer::face_pairs);
#pragma omp parallel for schedule(static, 128) if (count >= worth_threads)
  for (Index y = 0; y < count; ++y)
    std::sort(source.begin() + first[y], source.begin() + first[y + 1]);
}

/// Give the memory of the list before back.
void drop(OuterList& outer) {
  for (Column<Index>* indices :
       {&outer.vf_pairs, &outer.ee_pairs, &outer.ee_codes, &outer.slot_faces, &outer.slot_pairs,
        &outer.edge_pairs, &outer.edge_others, &outer.faces_acting_on})
    *indices = {};
  for (Column<float>* bounds : {&outer.vf_bounds, &outer.ee_bounds}) *bounds = {};
}

/// For every slot the faces that its vertex may touch.
void list_slot_candidates(PairBuffers& found, SearchState& search) {
  struct Listed {
    Index face, pair;
  };
  const Index slots = 4 * Index(search.exposed_face.size());
  std::vector<Index> first(slots + 1);
  const Counters number{first.data() + 1};
  for_each_found(found, &PairBuffer::candidates,
                 [&](const PairBuffer::Candidate& of) { number.raise(of.slot); });
  add_up(first, slots);
  Unset<Listed> listed(first.back());
  std::vector<Index> places(first.begin(), first.end() - 1);
  const Counters next{places.data()};
  for_each_found(found, &PairBuffer::candidates, [&](const PairBuffer::Candidate& of) {
    listed[next.raise(of.slot)] = {of.face, of.pair};
  });
  drop(found, &PairBuffer::candidates);
  search.outer.slot_first.assign(first);
  search.outer.slot_faces.renew(listed.size());
  search.outer.slot_pairs.renew(listed.size());
  const auto faces = on_host(search.outer.slot_faces), pairs = on_host(search.outer.slot_pairs);
#pragma omp parallel for schedule(dynamic, 256) if (slots >= worth_threads)
  for (Index slot = 0; slot < slots; ++slot) {
    std::sort(listed.begin() + first[slot], listed.begin() + first[slot + 1],
              [](const Listed& a, const Listed& b) { return a.face < b.face; });
    for (Index i = first[slot]; i < first[slot + 1]; ++i) {
      faces[i] = listed[i].face;
      pairs[i] = listed[i].pair;
    }
  }
}

}  // namespace

void list_candidates(const Model& m, State& s) {
  predict_motion(m, s);
  drop(s.search.outer);
  PairBuffers found;
  {
    PairSearch search;
    search_pairs(m, s, search);
    s.search.outer.rotation_soon.renew(search.exposed.size());
    const auto rotation_soon = on_host(s.search.outer.rotation_soon);
    for (std::size_t x = 0; x < search.exposed.size(); ++x)
      rotation_soon[x] = search.exposed[x].rotation_soon;
    found = std::move(search.found);
  }
  list_face_pairs(found, s.search);
  list_edge_pairs(found, s.search);
  list_pairs_of_edges(m, s.search);
  s.search.inner.known = false;
  list_sources(found, s.search);
  list_slot_candidates(found, s.search);
}

}  // namespace cdem
