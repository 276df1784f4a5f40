// loose_bolt.hpp - a bolt for tests, between nodes of its own.
#pragma once

#include <vector>

#include "core/bolts/solve_bolts.hpp"
#include "tests/core/bolts/chain_columns.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

/// A bolt whose points are nodes of their own, with one crossing: its sides are two more nodes.
struct LooseBolt {
  static constexpr Index nodes = 12, points = nodes + 2;
  ChainColumns columns{nodes, 0.25, 112e6, 0.175e6};
  std::vector<Real> motion = std::vector<Real>(8 * points);
  std::vector<Real> weights = std::vector<Real>(8 * points);
  std::vector<Real> force = std::vector<Real>(4 * 8 * points);
  std::vector<Index> hosts = std::vector<Index>(8 * points, -1);
  std::vector<Index> first{0, nodes}, crossing_first{0, 1}, crossing_bar{5};
  std::vector<Real> properties{18e6, 2e5, 2e5, 1e300, 0}, dowel{5e6, 1e4};
  std::vector<Real> dowel_free = std::vector<Real>(4), dowel_force = std::vector<Real>(4);
  std::vector<Real> stored{0}, lost{0}, jacked{0};
  std::vector<Flag> phase{Flag(BoltPhase::placed)};

  LooseBolt() {
    for (Index p = 0; p < points; ++p) {
      hosts[8 * p] = p;
      weights[8 * p] = 1;
      move(p, {p < nodes ? 0.25 * p : 1.375, 0, 0});
    }
  }
  void move(Index p, const Vec& x) {
    motion[8 * p] = x.x, motion[8 * p + 1] = x.y, motion[8 * p + 2] = x.z;
  }
  Vec position(Index p) const { return {motion[8 * p], motion[8 * p + 1], motion[8 * p + 2]}; }
  Vec force_on(Index p) const {
    const Real* f = force.data() + 32 * std::size_t(p);
    return {f[0], f[1], f[2]};
  }
  SolveBolt solver() {
    return {.nodes = {motion.data()},
            .first = first.data(),
            .crossing_first = crossing_first.data(),
            .node_count = nodes,
            .hosts = hosts.data(),
            .weights = weights.data(),
            .properties = properties.data(),
            .columns = columns.chain().n,
            .dowels = {.bar = crossing_bar.data(),
                       .dowel = dowel.data(),
                       .free_jump = dowel_free.data(),
                       .force = dowel_force.data()},
            .phase = phase.data(),
            .stored = stored.data(),
            .lost = lost.data(),
            .jacked = jacked.data(),
            .corner_force = force.data()};
  }
  void solve() { solver()(One{0}); }
};

}  // namespace cdem::test
