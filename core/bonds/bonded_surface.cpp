// bonded_surface.cpp - see bonded_surface.hpp.
#include "core/bonds/bonded_surface.hpp"

#include "core/base/primitives.hpp"
#include "core/bonds/joined_nodes.hpp"
#include "core/bonds/surface_rows.hpp"
#include "core/model/force_sets.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

namespace {

/// Call visit(set, its state) for the sets of conforming pairs.
template <class Visit>
void for_each_conforming_set(const Model& m, const State& s, Visit&& visit) {
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    if (conforms(p)) visit(p, ps);
  });
}

/// Join nodes that pairs of other ranks join. Each node has the lowest number of the whole model
/// that its label has met; owners tell them to ghosts, until none becomes lower.
void join_labels_of_ranks(const Model& m, State& s, const Labels& labels,
                          const Column<Index>& numbers) {
  if (!s.share.exchange) return;
  const Index count = m.node_count;
  Column<Real> lowest, told;
  lowest.renew(count);
  told.renew(count);
  for_each_item({}, count, NumberOfNode{numbers.data(), told.data()});
  set_all({}, count, lowest.data(), infinity);
  const TellLowest tell{labels.label, lowest.data(), told.data()};
  const IsToldLower lower{labels.label, lowest.data(), told.data()};
  while (any_rank(s, any_item({}, count, lower))) {
    for_each_item({}, count, LowerLabels{labels, told.data(), lowest.data()});
    for_each_item({}, count, tell);
    to_ghosts(s, told.data(), {.width = 1, .count = 1});
  }
  for_each_item({}, count, tell);
  Column<std::uint64_t> keys;
  Column<Index> nodes;
  keys.renew(count);
  nodes.renew(count);
  for_each_item({}, count, KeysOfLowest{told.data(), keys.data(), nodes.data()});
  sort_pairs({}, count, keys.data(), nodes.data());
  for_each_item({}, count - 1, JoinSameKeys{keys.data(), nodes.data(), labels});
  for_each_item({}, count, FinishLabels{labels});
}

void join_nodes(const Model& m, State& s) {
  const Labels labels{s.nodes.bonded_node.data(), runs_alone()};
  for_each_item({}, m.node_count, StartLabels{nullptr, labels.label});
  for_each_conforming_set(m, s, [&](const PairSet& p, const PairState& ps) {
    for_each_item({}, p.count,
                  JoinBondedNodes{.status = ps.status.data(),
                                  .bond = ps.bond.data(),
                                  .nodes = p.nodes.data(),
                                  .points = p.points,
                                  .stride = p.stride,
                                  .stride_points = p.point_stride,
                                  .labels = labels});
  });
  for_each_item({}, m.node_count, FinishLabels{labels});
  join_labels_of_ranks(m, s, labels, s.share.node);
}

void join_bodies(const Model& m, State& s) {
  const Labels labels{s.nodes.body.data(), runs_alone()};
  for_each_item({}, m.node_count, StartLabels{m.block_first.data(), labels.label});
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    for_each_item({}, p.count,
                  JoinBodies{.status = ps.status.data(),
                             .faces = p.faces.data(),
                             .face_nodes = m.face_nodes.data(),
                             .labels = labels});
  });
  for_each_item({}, m.node_count, FinishLabels{labels});
  join_labels_of_ranks(m, s, labels, s.share.block);
}

/// Edge stars of the points that vertices of exposed faces belong to: other ends of all edges that
/// leave any node of the point, once each, and by a node of an exposed face if there is one.
void merge_edge_stars(const Model& m, State& s) {
  const Index* const bonded_node = s.nodes.bonded_node.data();
  const Index* const own = m.edge_star.data();
  Column<Flag> exposed, wanted;  // [node], [label]
  for (Column<Flag>* flags : {&exposed, &wanted}) {
    flags->renew(m.node_count);
    set_all({}, m.node_count, flags->data(), Flag(0));
  }
  for_each_item({}, Index(s.search.exposed_face.size()),
                MarkExposedPoints{.exposed_face = s.search.exposed_face.data(),
                                  .face_nodes = m.face_nodes.data(),
                                  .bonded_node = bonded_node,
                                  .exposed = exposed.data(),
                                  .wanted = wanted.data()});
  Column<Index> first, edges;
  list_rows({}, m.node_count, Index(m.edge_star.size()), m.node_count,
            EdgesOfPoints{.own_first = m.edge_star_first.data(),
                          .own = own,
                          .bonded_node = bonded_node,
                          .exposed = exposed.data(),
                          .wanted = wanted.data()},
            first, edges);
  list_items(
      {}, m.node_count,
      EndsOfPoints{
          .first = first.data(), .edges = edges.data(), .own = own, .bonded_node = bonded_node},
      s.search.edge_star_first, s.search.edge_star);
}

void find_across(const Model& m, State& s) {
  Column<Index> mate;
  mate.renew(m.face_count);
  set_all({}, m.face_count, mate.data(), Index(-1));
  for_each_conforming_set(m, s, [&](const PairSet& p, const PairState& ps) {
    for_each_item({}, p.count, FindMates{ps.status.data(), p.faces.data(), mate.data()});
  });
  const std::size_t slots = 4 * s.search.exposed_face.size();
  s.search.across.renew(slots);
  for_each_item({}, Index(slots),
                FindAcross{.exposed_face = s.search.exposed_face.data(),
                           .face_exposed = s.search.face_exposed.data(),
                           .face_nodes = m.face_nodes.data(),
                           .face_edges = m.face_edges.data(),
                           .edge_nodes = m.edge_nodes.data(),
                           .edge_faces = m.edge_faces.data(),
                           .bonded_node = s.nodes.bonded_node.data(),
                           .mate = mate.data(),
                           .across = s.search.across.data()});
}

/// How many bond points of conforming pairs are intact.
Real bonded_points(const Model& m, const State& s) {
  Real sum = 0;
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    if (conforms(p)) sum += column_sum({}, ps.bond, {});
  });
  return sum;
}

}  // namespace

void join_surfaces(const Model& m, State& s, bool released) {
  const Index faces = Index(s.search.exposed_face.size());
  const Real points = bonded_points(m, s);
  const bool known = faces == s.search.joined_faces && points == s.search.joined_points;
  if (!any_rank(s, released || !known)) return;
  s.search.joined_faces = faces;
  s.search.joined_points = points;
  join_nodes(m, s);
  join_bodies(m, s);
  merge_edge_stars(m, s);
  find_across(m, s);
}

}  // namespace cdem
