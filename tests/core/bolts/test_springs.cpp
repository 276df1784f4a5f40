// The stiffness of a bolt is the change of its force by a small motion.
#include "core/bolts/springs.hpp"
#include "tests/core/bolts/loose_bolt.hpp"

namespace cdem::test {

namespace {

constexpr Index bar = 5;  // leads across the joint, from node 5 to node 6
constexpr Real small = 1e-7;

std::vector<NodeSpring> springs_of(LooseBolt& bolt) {
  std::vector<NodeSpring> springs;
  add_springs(bolt.solver(), 0, springs);
  return springs;
}

/// The joint opens by a step, and shifts by another: nodes and one side of the crossing beyond it.
void move_beyond(LooseBolt& bolt, const Vec& by) {
  for (Index p = bar + 1; p < LooseBolt::points; ++p)
    if (p != LooseBolt::nodes) bolt.move(p, bolt.position(p) + by);
}

}  // namespace

TEST_CASE("a bar that is pulled alone: the bar, and the grout on both sides") {
  LooseBolt bolt;
  bolt.columns.end = std::vector<Real>(2 * LooseBolt::nodes);
  bolt.solve();
  const NodeSpring spring = springs_of(bolt).at(bar);
  CHECK(spring.count == 2);
  CHECK((spring.node[0] == bar && spring.node[1] == bar + 1));
  CHECK((spring.weight[0] == -1 && spring.weight[1] == 1));
  CHECK((spring.axis.x == doctest::Approx(1) && spring.shear == 0));
  move_beyond(bolt, {small, 0, 0});
  bolt.solve();
  CHECK(relative_error(bolt.columns.axial_force[bar], spring.normal * small) < 1e-8);
}

TEST_CASE("grout that slips, and steel that is torn, are no springs") {
  LooseBolt bolt;
  bolt.solve();
  const Real whole = springs_of(bolt).at(bar).normal;
  move_beyond(bolt, {0.1, 0, 0});  // more than the grout of both sides can bear
  bolt.solve();
  CHECK(springs_of(bolt).at(bar).normal < 1e-5 * whole);
  const std::size_t bars = springs_of(bolt).size();
  bolt.columns.bar_broken[bar] = Flag(BarState::ruptured);
  CHECK(springs_of(bolt).size() == bars - 2);  // the dowel there has gone, too
}

TEST_CASE("a dowel resists a shift of the joint, until it yields") {
  LooseBolt bolt;
  bolt.solve();
  const NodeSpring spring = springs_of(bolt).back();
  CHECK((spring.node[0] == LooseBolt::nodes && spring.node[1] == LooseBolt::nodes + 1));
  CHECK(spring.normal == 0);
  const std::size_t all = springs_of(bolt).size();
  bolt.move(LooseBolt::nodes + 1, bolt.position(LooseBolt::nodes + 1) + Vec{0, small, 0});
  bolt.solve();
  CHECK(relative_error(bolt.dowel_force[1], spring.shear * small) < 1e-8);
  bolt.move(LooseBolt::nodes + 1, bolt.position(LooseBolt::nodes + 1) + Vec{0, 1, 0});
  bolt.solve();
  CHECK(springs_of(bolt).size() == all - 1);
}

TEST_CASE("a bolt that is not installed, or removed, has none") {
  LooseBolt bolt;
  CHECK(springs_of(bolt).empty());
  bolt.solve();
  CHECK(!springs_of(bolt).empty());
  bolt.phase[0] = Flag(BoltPhase::removed);
  CHECK(springs_of(bolt).empty());
}

}  // namespace cdem::test
