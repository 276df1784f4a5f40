// outer_list.cpp - see outer_list.hpp.
#include "core/contact/pair_list/outer_list.hpp"

#include "core/base/primitives.hpp"
#include "core/contact/broad_phase/edge_edge_pairs.hpp"
#include "core/contact/broad_phase/exposed_patches.hpp"
#include "core/contact/broad_phase/pair_search.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/force/stiffness_sums.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/pair_list/outer_faces.hpp"
#include "core/contact/pair_list/views.hpp"

namespace cdem {

namespace {

/// Give the memory of the list before back.
void drop(OuterList& outer) {
  for (Column<Index>* indices :
       {&outer.vf_pairs, &outer.ee_pairs, &outer.ee_codes, &outer.slot_pairs, &outer.edge_pairs,
        &outer.acting_first, &outer.faces_acting_on})
    *indices = {};
  for (Column<Short>* bounds : {&outer.vf_bounds, &outer.ee_bounds}) *bounds = {};
}

/// Room for `count` pairs with two members and six bounds each; lanes go on past the last.
Index make_room(Queue q, Index count, Column<Index>& of, Column<Short>& room) {
  const Index stride = padded_stride(count);
  of.renew(2 * std::size_t(stride));
  room.renew(6 * std::size_t(stride));
  for (Index k = 0; k < 2; ++k)
    set_all(q, stride - count, of.data() + std::size_t(k) * stride + count, Index(0));
  return stride;
}

/// List the pairs of vertex and face, and by slot the faces that its vertex may touch.
void list_vertex_faces(const PairContext& f, PairSearch& search, SearchState& s, Queue q) {
  OuterList& outer = s.outer;
  const Index count = Index(search.vertex_faces.size());
  const Index stride = make_room(q, count, outer.vf_pairs, outer.vf_bounds);
  for_each_item(q, count,
                WriteVertexFaces{.f = f,
                                 .pairs = search.pairs.data(),
                                 .items = search.vertex_faces.data(),
                                 .stride = stride,
                                 .of = outer.vf_pairs.data(),
                                 .room = outer.vf_bounds.data(),
                                 .alone = runs_alone()});
  Column<Candidate> candidates;
  list_items(q, count, ListSemiSprings{f, search.pairs.data(), search.vertex_faces.data()},
             candidates);
  const Index listed = Index(candidates.size()), slots = 4 * Index(s.exposed_face.size());
  list_rows_in_room(q, listed, listed, slots, RowOfCandidate{candidates.data()}, outer.slot_first,
                    outer.slot_pairs);
  for_each_item(q, listed, WriteSlotPairs{candidates.data(), outer.slot_pairs.data()});
}

/// List the pairs of edges, and for every edge of the mesh those with edges of higher numbers.
void list_edge_pairs(const Model& m, const PairContext& f, PairSearch& search, SearchState& s,
                     Queue q) {
  OuterList& outer = s.outer;
  const Index count = Index(search.edges.size());
  const Index stride = make_room(q, count, outer.ee_pairs, outer.ee_bounds);
  outer.ee_codes.renew(count);
  for_each_item(q, count,
                WriteEdgePairs{.f = f,
                               .pairs = search.pairs.data(),
                               .moving = search.moving.data(),
                               .items = search.edges.data(),
                               .stride = stride,
                               .of = outer.ee_pairs.data(),
                               .codes = outer.ee_codes.data(),
                               .room = outer.ee_bounds.data(),
                               .alone = runs_alone()});
  outer.ee_sides.swap(search.edge_sides);
  const Index edges = Index(outer.ee_sides.size() / 2);
  outer.ee_edges.renew(edges);
  for_each_item(q, edges,
                FindEdges{.sides = outer.ee_sides.data(),
                          .exposed_face = s.exposed_face.data(),
                          .face_edges = m.face_edges.data(),
                          .edges = outer.ee_edges.data()});
  outer.edge_first.resize(0);
  if (count == 0) return outer.edge_pairs.renew(0);
  list_rows_in_room(q, count, count, Index(m.edge_nodes.size() / 2),
                    RowOfEdges{edges_of_pairs(outer)}, outer.edge_first, outer.edge_pairs);
}

/// Mark the exposed faces on the lists, and find the stiffest contact that each may have.
Column<Real> mark_listed_faces(const Model& m, const PairSearch& search, State& s, Queue q) {
  const Index faces = Index(s.search.exposed_face.size());
  Column<Flag>& listed = s.search.outer.face_listed;
  Column<Real> stiffest;
  stiffest.renew(faces);
  set_all(q, faces, stiffest.data(), Real(0));
  listed.renew(faces);
  set_all(q, faces, listed.data(), Flag(0));
  for_each_item(
      q, Index(search.pairs.size()),
      MarkListedFaces<ListFacePairs>{.pairs = {search.patches.data(), search.pairs.data()},
                                     .laws = contact_laws(m, s),
                                     .geometry = face_geometry(s),
                                     .alone = runs_alone(),
                                     .listed = listed.data(),
                                     .stiffest = stiffest.data()});
  return stiffest;
}

/// For every exposed face list the others whose contacts may act on it, for laws that ask for
/// areas.
void list_acting_faces(const PairSearch& search, SearchState& s, Queue q) {
  OuterList& outer = s.outer;
  Column<FacePair> pairs;
  list_items(q, Index(search.pairs.size()),
             ListFacePairs{search.patches.data(), search.pairs.data()}, pairs);
  const Index count = Index(pairs.size());
  list_rows_in_room(q, count, count, Index(s.exposed_face.size()), RowOfActingFace{pairs.data()},
                    outer.acting_first, outer.faces_acting_on);
  for_each_item(q, count, WriteActingFaces{pairs.data(), outer.faces_acting_on.data()});
}

}  // namespace

Column<Real> list_candidates(const Model& m, State& s) {
  const Queue q;
  predict_motion(m, s);
  drop(s.search.outer);
  PairSearch search;
  search_pairs(m, s, search);
  const PairContext f = pair_context(m, s, search);
  s.search.outer.rotation_soon.renew(search.exposed.size());
  for_each_item(q, Index(search.exposed.size()),
                CopyRotations{search.exposed.data(), s.search.outer.rotation_soon.data()});
  list_vertex_faces(f, search, s.search, q);
  search.vertex_faces = {};
  list_edge_pairs(m, f, search, s.search, q);
  search.edges = {};
  search.moving = {};
  s.search.inner.known = false;
  if (m.interface_traits.ask_area) list_acting_faces(search, s.search, q);
  return mark_listed_faces(m, search, s, q);
}

}  // namespace cdem
