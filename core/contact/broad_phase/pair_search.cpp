// pair_search.cpp - see pair_search.hpp.
#include "core/contact/broad_phase/pair_search.hpp"

#include <algorithm>
#include <vector>

#include "core/base/primitives.hpp"
#include "core/contact/broad_phase/edge_edge_pairs.hpp"
#include "core/contact/broad_phase/exposed_patches.hpp"
#include "core/contact/broad_phase/near_boxes.hpp"
#include "core/contact/broad_phase/patch_pairs.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/broad_phase/vertex_face_pairs.hpp"
#include "core/contact/geometry/views.hpp"

namespace cdem {

namespace {

ElementSurface element_surface(const Model& m, const State& s) {
  return {.faces = face_columns(m, s),
          .predicted = predicted_nodes(s),
          .lookahead_time = s.search.outer.lookahead_time,
          .rules = m.rules,
          .exposed_face = s.search.exposed_face.data(),
          .block = m.face_block.data(),
          .movable = m.face_movable.data(),
          .area = m.face_area.data(),
          .reach = m.face_reach.data(),
          .target = s.springs.target.data(),
          .edge_first = s.edges.first.data(),
          .springs = s.springs.state.data(),
          .edges = s.edges.state.data()};
}

/// List items in batches of rows, one after the other: `list(rows, items)` lists those of some
/// rows.
template <class Item, class List>
void list_in_batches(Queue q, Index rows, Index at_once, Column<Item>& all, const List& list) {
  std::vector<Column<Item>> batches;
  std::size_t count = 0;
  for (Index first = 0; first < rows; first += at_once) {
    Column<Item> found;
    list(Range{first, first + std::min(at_once, rows - first)}, found);
    Column<Item>& kept = batches.emplace_back();
    kept.renew(found.size());  // not longer than needed
    copy_items(q, Index(found.size()), found.data(), kept.data());
    count += found.size();
  }
  if (batches.size() == 1) return all.swap(batches[0]);
  all.renew(count);
  std::size_t place = 0;
  for (Column<Item>& batch : batches) {
    copy_items(q, Index(batch.size()), batch.data(), all.data() + place);
    place += batch.size();
    batch = {};
  }
}

/// Of a rank: mark the patches that reach no own one before the next rebuild.
void mark_far(const State& s, const Column<Box>& boxes, Column<Patch>& patches) {
  if (!s.share.exchange) return;
  const Queue q;
  const Index count = Index(patches.size());
  Column<Real> reach;
  Column<Flag> near;
  reach.renew(count);
  near.renew(count);
  set_all(q, count, reach.data(), Real(0));
  for_each_item(q, count,
                FlagOwnPatches{.patches = patches.data(),
                               .own_face = s.share.counted("exposed").own,
                               .own_node = s.share.counted("nodes").own,
                               .flags = near.data()});
  flag_near(boxes, reach, near);
  for_each_item(q, count, MarkFarPatches{near.data(), patches.data()});
}

/// Pairs of patches, and their parts that may touch.
void find_patch_pairs(const Model& m, const State& s, PairSearch& search) {
  const Queue q;
  const Index count = Index(search.patches.size());
  Column<Box> boxes;
  boxes.renew(count);
  for_each_item(q, count, CopyBoxes{search.patches.data(), boxes.data()});
  mark_far(s, boxes, search.patches);
  BoxTreeColumns tree;
  tree.make(q, boxes);
  const PairContext f = pair_context(m, s, search);
  const auto list = [&](Range of, Column<PatchPair>& pairs) {
    list_items(q, of.last - of.first, ListPatchPairs{search.patches.data(), tree.tree(), of.first},
               pairs);
    keep_items(q, MayMeet{f}, pairs);
    const Index found = Index(pairs.size());
    for_each_item(q, found, SortByOther{pairs.data(), found});
    keep_items(q, FindMeetingParts{f, m.interface_traits.ask_area}, pairs);
  };
  list_in_batches(q, count, search.at_once, search.pairs, list);
}

}  // namespace

PairContext pair_context(const Model& m, const State& s, const PairSearch& search) {
  return {.rules = m.rules,
          .lookahead_time = s.search.outer.lookahead_time,
          .faces = face_columns(m, s),
          .predicted = predicted_nodes(s),
          .face_reach = m.face_reach.data(),
          .exposed = search.exposed.data(),
          .sides = search.sides.data(),
          .patches = search.patches.data(),
          .bonded = search.bonded.view(),
          .target = s.springs.target.data(),
          .edge_first = s.edges.first.data(),
          .edge_contact = s.edges.contact.data()};
}

void list_patches(const Model& m, const State& s, PairSearch& search) {
  const Queue q;
  const ElementSurface surface = element_surface(m, s);
  const Index faces = Index(s.search.exposed_face.size());
  search.exposed.renew(faces);
  search.sides.renew(4 * std::size_t(faces));
  for_each_item(q, faces, MakeExposedFaces{surface, search.exposed.data()});
  for_each_item(q, faces,
                MakeExposedSides{.exposed = search.exposed.data(),
                                 .beyond = s.search.across.data(),
                                 .face_exposed = s.search.face_exposed.data(),
                                 .sides = search.sides.data()});
  Column<Index> first, edges, edge_first;
  select_items(q, faces, BeginsPatch{surface.exposed_face, m.face_element.data()}, first);
  const Index patches = Index(first.size());
  search.patches.renew(patches);
  edges.renew(patches);
  for_each_item(q, patches,
                MakePatches{.of = surface,
                            .exposed = search.exposed.data(),
                            .first = first.data(),
                            .patches = patches,
                            .faces = faces,
                            .list = search.patches.data(),
                            .edge_count = edges.data()});
  edge_first.renew(std::size_t(patches) + 1);
  search.edge_sides.renew(2 * std::size_t(scan(q, patches, edges.data(), edge_first.data())));
  for_each_item(q, patches,
                ListEdgeSides{edge_first.data(), search.patches.data(), search.edge_sides.data()});
}

void search_pairs(const Model& m, const State& s, PairSearch& search) {
  const Queue q;
  list_patches(m, s, search);
  search.bonded = live_overlaps(m, s);
  find_patch_pairs(m, s, search);
  const PairContext f = pair_context(m, s, search);
  const PatchPair* const pairs = search.pairs.data();
  const Index count = Index(search.pairs.size()), at_once = 16 * search.at_once;
  list_in_batches(q, count, at_once, search.vertex_faces,
                  [&](Range of, Column<VertexFaceItem>& items) {
                    list_items(q, of.last - of.first, ListVertexFaces{f, pairs, of.first}, items);
                    keep_items(q, VertexMayTouch{f, pairs}, items);
                  });
  if (!m.semi_edges) return;
  search.moving.renew(search.edge_sides.size() / 2);
  MovingEdge* const moving = search.moving.data();
  for_each_item(q, Index(search.patches.size()), MakeMovingEdges{f, moving});
  list_in_batches(q, count, at_once, search.edges, [&](Range of, Column<EdgeItem>& items) {
    const ListEdgesOfPatches list{.f = f, .pairs = pairs, .moving = moving, .first = of.first};
    list_items(q, of.last - of.first, list, items);
    keep_items(q, EdgesMayTouch{f, pairs, moving}, items);
  });
}

}  // namespace cdem
