// Forces of bolts on the rock, and their energy.
#include "core/bolts/solve_bolts.hpp"
#include "tests/core/bolts/loose_bolt.hpp"

namespace cdem::test {

namespace {}  // namespace

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
