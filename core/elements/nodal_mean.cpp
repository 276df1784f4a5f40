// nodal_mean.cpp - see nodal_mean.hpp.
#include "core/elements/nodal_mean.hpp"

#include <algorithm>
#include <vector>

#include "core/elements/nodal_dilatation.hpp"
#include "core/elements/tiles.hpp"
#include "core/elements/views.hpp"
#include "core/model/phase_timer.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

namespace {

Blocks blocks_of(const Column<Index>& list) {
  static constexpr Index none = 0;  // a null pointer would stand for all
  return {list.size() > 0 ? list.data() : &none, Index(list.size())};
}

Blocks averaged_tets(const State& s) { return blocks_of(s.nodal.blocks); }

NodalDilatation dilatation(const Model& m, const State& s, const Column<Real>& at_nodes) {
  return {.tet_nodes = {m.tet4.nodes.data(), m.tet4.stride},
          .averaged = {m.tet4.nodal_mean.data()},
          .start = {s.nodal.start.data(), m.tet4.stride},
          .at_nodes = at_nodes.data()};
}

PointFlow<Tet4> flow_of_tets(const Model& m, State& s) {
  return point_flow<Tet4>(s, m.tet4, s.tet4);
}

void find_dilatation(const Model& m, State& s, Queue q) {
  for_each_lane(q, m.tet4.count, averaged_tets(s),
                FindDilatation{.columns = element_columns<Tet4>(m, s, m.tet4),
                               .flow = flow_of_tets(m, s),
                               .start = {s.nodal.start.data(), m.tet4.stride},
                               .own = {s.nodal.own.data(), m.tet4.stride}});
}

/// Nodes that another rank owns have its average.
void average(const Model& m, State& s, Queue q, Column<Real>& at_nodes) {
  for_each_item(q, Index(s.nodal.nodes.size()),
                AverageAtNodes{.nodes = s.nodal.nodes.data(),
                               .first = s.nodal.tet_first.data(),
                               .tets = s.nodal.tet.data(),
                               .volume = m.tet4.volume.data(),
                               .own = s.nodal.own.data(),
                               .at_nodes = at_nodes.data()});
  to_ghosts(s, at_nodes.data(), {.width = 1, .count = 1});
}

/// The initial dilatation of tets is from initial stress: it is not averaged, and stays in
/// equilibrium.
void begin(const Model& m, State& s, Queue q) {
  s.nodal.start.resize(m.tet4.stride);
  find_dilatation(m, s, q);
  s.nodal.start.assign(s.nodal.own.data(), m.tet4.stride);
  s.nodal.after.resize(m.node_count);
}

/// Tiles with an averaged tet, block by block, and the others.
void list_tets(const ElementSet& e, const ElementTiles& tiles, NodalMeans& n) {
  const auto block_first = on_host(tiles.block_first);
  const auto nodal_mean = on_host(e.nodal_mean);
  std::vector<Index> blocks, other_blocks;
  for (std::size_t tile = 0; tile + 1 < block_first.size(); ++tile) {
    const Index begin = block_first[tile], end = block_first[tile + 1];
    const Flag *first = nodal_mean.begin() + begin * block_size,
               *last = nodal_mean.begin() + std::min(end * block_size, e.count);
    const bool averaged = std::find(first, last, 1) != last;
    for (Index b = begin; b < end; ++b) (averaged ? blocks : other_blocks).push_back(b);
  }
  n.blocks.assign(blocks);
  n.other_blocks.assign(other_blocks);
}

/// Nodes of averaged tets, and the tets of all nodes.
void list_nodes(const Model& m, NodalMeans& n) {
  const ElementSet& e = m.tet4;
  const auto nodes = on_host(e.nodes);
  const auto nodal_mean = on_host(e.nodal_mean);
  std::vector<Flag> averages(m.node_count);
  std::vector<Index> first(m.node_count + 1), tets(4 * std::size_t(e.count));
  const auto visit = [&](auto&& act) {
    for (Index i = 0; i < e.count; ++i)
      for (Index k = 0; k < 4; ++k) act(nodes[std::size_t(k) * e.stride + i], i);
  };
  visit([&](Index node, Index tet) {
    ++first[node + 1];
    averages[node] |= nodal_mean[tet];
  });
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  n.tet_first.assign(first);
  visit([&](Index node, Index tet) { tets[first[node]++] = tet; });
  n.tet.assign(tets);
  std::vector<Index> averaged;
  for (Index i = 0; i < m.node_count; ++i)
    if (averages[i]) averaged.push_back(i);
  n.nodes.assign(averaged);
}

}  // namespace

Blocks other_tets(const State& s) { return blocks_of(s.nodal.other_blocks); }

void list_nodal_means(const Model& m, State& s) {
  if (!has_nodal_means(m)) return;
  NodalMeans& n = s.nodal;
  list_tets(m.tet4, s.tet4.tiles, n);
  list_nodes(m, n);
  n.own.resize(m.tet4.stride);
  n.flowed.resize(m.tet4.stride);
  n.trial.resize(m.node_count);
}

void update_nodal_means(const Model& m, State& s, Queue q) {
  if (!has_nodal_means(m)) return;
  const PhaseTimer timer(s, Phase::element);
  if (s.nodal.after.size() == 0) begin(m, s, q);
  find_dilatation(m, s, q);
  average(m, s, q, s.nodal.trial);
  for_each_lane(q, m.tet4.count, averaged_tets(s),
                FlowOfTets{.columns = element_columns<Tet4>(m, s, m.tet4),
                           .flow = flow_of_tets(m, s),
                           .trial = dilatation(m, s, s.nodal.trial),
                           .before = dilatation(m, s, s.nodal.after),
                           .own = {s.nodal.own.data(), m.tet4.stride},
                           .flowed = {s.nodal.flowed.data(), m.tet4.stride}});
  average(m, s, q, s.nodal.after);
}

void update_averaged_tets(const Model& m, State& s, Queue q) {
  const ElementSet& e = m.tet4;
  const NodalFlow flow{.flow = flow_of_tets(m, s),
                       .after = dilatation(m, s, s.nodal.after),
                       .flowed = {s.nodal.flowed.data(), e.stride}};
  const auto update = [&]<class Damping>(const Damping& damping) {
    for_each_tile(q, e.count, averaged_tets(s), tiles_of(e, s.tet4, s),
                  CorotationalForce<Tet4, FollowRotation, NodalFlow, Damping>{
                      .columns = element_columns<Tet4>(m, s, e),
                      .damping_time = m.stiffness_damping * s.dt,
                      .dt = s.dt,
                      .damping_work = {s.tet4.damping_work.data(), e.stride},
                      .flow = flow,
                      .damping = damping});
  };
  if (remembers(s.tet4))
    update(rock_damping<Tet4>(m, s, e, s.tet4, false));
  else
    update(NoRockDamping{});
}

bool report_averaged_tets(const Model& m, State& s, Queue q, bool ahead) {
  if (s.nodal.after.size() == 0) return false;
  find_dilatation(m, s, q);
  average(m, s, q, s.nodal.trial);
  const ElementSet& e = m.tet4;
  const NodalReport flow{.flow = flow_of_tets(m, s),
                         .now = dilatation(m, s, s.nodal.trial),
                         .own = {s.nodal.own.data(), e.stride}};
  const auto report = [&]<class Damping>(const Damping& damping) {
    for_each_lane(q, e.count, averaged_tets(s),
                  CorotationalReport<Tet4, FollowRotation, NodalReport, Damping>{
                      .columns = element_columns<Tet4>(m, s, e),
                      .stress = {s.tet4.stress.data(), e.stride},
                      .energy = {s.tet4.energy.data(), e.stride},
                      .yielded = {s.tet4.yielded.data(), e.stride},
                      .flow = flow,
                      .damping = damping});
  };
  if (remembers(s.tet4))
    report(rock_damping<Tet4>(m, s, e, s.tet4, ahead));
  else
    report(NoRockDamping{});
  return true;
}

}  // namespace cdem
