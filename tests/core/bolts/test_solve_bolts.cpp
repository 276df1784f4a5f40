// Forces of bolts on the rock, and their energy.
#include "core/bolts/solve_bolts.hpp"
#include "tests/core/bolts/chain_columns.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

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
  void solve() {
    const SolveBolt kernel{.nodes = {motion.data()},
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
    kernel(One{0});
  }
};

}  // namespace

TEST_CASE("where it is installed a bolt is free of force") {
  LooseBolt bolt;
  bolt.solve();
  for (Index p = 0; p < bolt.points; ++p) CHECK(norm(bolt.force_on(p)) == 0);
  CHECK(bolt.phase[0] == Flag(BoltPhase::acting));
}

TEST_CASE("forces sum to zero; so do moments but for those of dowels, shift times force") {
  LooseBolt bolt;
  bolt.solve();
  Random random(11);
  for (Index p = 0; p < bolt.nodes; ++p) bolt.move(p, bolt.position(p) + random.vector(1e-3));
  bolt.solve();
  Vec sum{0, 0, 0}, moment{0, 0, 0};
  Real largest = 0;
  for (Index p = 0; p < bolt.points; ++p) {
    sum = sum + bolt.force_on(p);
    moment = moment + cross(bolt.position(p), bolt.force_on(p));
    largest = std::max(largest, norm(bolt.force_on(p)));
  }
  CHECK(largest > 1e3);
  CHECK(norm(sum) < 1e-10 * largest);
  CHECK(norm(moment) < 1e-10 * largest);
}

TEST_CASE("a dowel bears K times the shift across the bolt, and at most its strength") {
  LooseBolt bolt;
  bolt.solve();
  bolt.move(13, bolt.position(13) + Vec{5e-4, 1e-3, 0});
  bolt.solve();
  CHECK(distance(bolt.force_on(12), {0, 5e3, 0}) < 1e-9 * 5e3);
  CHECK(distance(bolt.force_on(13), {0, -5e3, 0}) < 1e-9 * 5e3);
  bolt.move(13, bolt.position(13) + Vec{0, 9e-3, 0});
  bolt.solve();
  CHECK(distance(bolt.force_on(12), {0, 1e4, 0}) < 1e-9 * 1e4);
}

TEST_CASE("work of the rock on a bolt is what it stores and what it loses") {
  LooseBolt bolt;
  bolt.solve();
  Random random(5);
  Real work = 0;
  for (int step = 0; step < 400; ++step) {
    std::vector<Vec> force(bolt.points), way(bolt.points);
    for (Index p = 0; p < bolt.points; ++p) force[p] = bolt.force_on(p);
    for (Index p = 0; p < bolt.points; ++p) {
      const Real side = p < 6 || p == 12 ? -1 : 1;
      way[p] = Real(2e-5 * side) * Vec{step < 250 ? 1.0 : -1.0, 0, 0} +
               Real(2e-7) * Vec{0, side * random.between(0, 1), 0};
      bolt.move(p, bolt.position(p) + way[p]);
    }
    bolt.solve();
    for (Index p = 0; p < bolt.points; ++p) work -= 0.5 * dot(force[p] + bolt.force_on(p), way[p]);
  }
  CHECK(bolt.lost[0] > 0.1 * work);
  CHECK(relative_error(bolt.stored[0] + bolt.lost[0], work) < 5e-6);
}

TEST_CASE("the jack's work is what pretension has stored, and a bolt that waits does nothing") {
  LooseBolt bolt;
  bolt.columns.end[0] = 1e9, bolt.columns.end[1] = 1e300;
  bolt.properties[4] = 3e4;
  bolt.phase[0] = Flag(BoltPhase::waiting);
  bolt.solve();
  CHECK(bolt.stored[0] == 0);
  bolt.phase[0] = Flag(BoltPhase::placed);
  bolt.solve();
  CHECK(relative_error(bolt.columns.end_force[0], 3e4) < 1e-4);
  CHECK(bolt.stored[0] > 0);
  CHECK(relative_error(bolt.stored[0], bolt.jacked[0] - bolt.lost[0]) < 1e-9);
  const Real before = bolt.columns.end_force[0];
  bolt.solve();  // locked
  CHECK(relative_error(bolt.columns.end_force[0], before) < 1e-9);
}

}  // namespace cdem::test
