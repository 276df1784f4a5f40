// Rayleigh dashpots of bonds: force, loss, rotation, broken points, lanes.
#include "core/base/parallel.hpp"
#include "core/bonds/bond_dashpots.hpp"
#include "core/bonds/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// BracedPairs of bonded boxes, one pair a column.
struct BracedPairs : Scene {
  std::vector<Real> force, work;
  static constexpr Real dt = 1e-3, time = 0.2;

  explicit BracedPairs(Index pairs) {
    bonded = true;
    for (Index p = 0; p < pairs; ++p) {
      const Vec at{4.0 * p, 0, 0};
      add_box(at, {1, 1, 1});
      add_box(at + Vec{0, 0, 1}, {1, 1, 1});
    }
    build();
    set_interface({{"cohesion", 1e5}, {"tensile_strength", 1e5}, {"friction_angle", 0.5}});
    force.resize(12 * std::size_t(set().point_stride));
    work.resize(set().stride);
  }
  const PairSet& set() const { return model.quads; }
  BondDashpots<4> kernel() {
    const ConformingBonds<4> bonds{
        .nodes = {state.nodes.motion.data()},
        .pair_nodes = {set().nodes.data(), set().stride},
        .pairs = pair_columns(model, set(), state.quads),
        .indentation = 0.3,
        .dt = dt,
        .sampled = true,
        .corner_force = {state.corner_force.data() + std::size_t(set().corner_first) * 4}};
    return {bonds,
            {.dt = dt,
             .per_step = time / dt,
             .force = {force.data(), set().point_stride},
             .work = {work.data(), set().stride}}};
  }
  Vec corner(Index pair, Index k) const {
    return vector_at(state.corner_force.data() + 4 * (set().corner_first + 4 * pair + k));
  }
  Index node(Index pair, Index k) const { return on_host(set().nodes)[k * set().stride + pair]; }
  /// Move the nodes by their velocities.
  void advance() {
    for (Index i = 0; i < model.node_count; ++i) put(motion(i), position(i) + dt * velocity(i));
  }
};

}  // namespace

TEST_CASE("a bond that opens is braked by its time times its stiffness times the rate") {
  BracedPairs pairs(1);
  const Vec rate{2e-5, 1e-5, 3e-5};
  for (Index k = 4; k < 8; ++k) put(pairs.motion(pairs.node(0, k)) + 4, rate);
  const auto k = on_host(pairs.set().stiffness);
  const Real area = on_host(pairs.set().area)[0], k_n = k[0], k_s = k[pairs.set().stride];
  const Vec expected =
      Real(-BracedPairs::time) * area * Vec{k_s * rate.x, k_s * rate.y, k_n * rate.z};
  for (Index n = 1; n <= 2; ++n) {
    pairs.advance();
    for (Real& f : on_host(pairs.state.corner_force)) f = 0;
    for_each_lane({}, 1, Blocks{}, pairs.kernel());
    Vec sum{0, 0, 0};
    for (Index j = 0; j < 4; ++j) sum = sum + pairs.corner(0, j);
    CHECK(distance(sum, expected) < 1e-7 * norm(expected));
    // by the mean force of a step: half of it in the first
    CHECK(relative_error(pairs.work[0], -dot(expected, rate) * BracedPairs::dt * (n - 0.5)) < 1e-7);
  }
}

TEST_CASE("the dashpots of a strained pair do not feel its turn") {
  BracedPairs pairs(1);
  Random random(1);
  const Vec jump{1e-4, 2e-4, 3e-4};
  for (Index k = 4; k < 8; ++k) {
    Real* mate = pairs.motion(pairs.node(0, k));
    put(mate, vector_at(mate) + jump);
  }
  const Mat turn{{std::cos(0.1), -std::sin(0.1), 0}, {std::sin(0.1), std::cos(0.1), 0}, {0, 0, 1}};
  const Mat other{{1, 0, 0}, {0, std::cos(0.1), -std::sin(0.1)}, {0, std::sin(0.1), std::cos(0.1)}};
  for (Index i = 0; i < pairs.model.node_count; ++i) {
    const Vec x = turn * (other * pairs.position(i));
    put(pairs.motion(i) + 4, Real(1 / BracedPairs::dt) * (x - pairs.position(i)));
    put(pairs.motion(i), x);
  }
  for_each_lane({}, 1, Blocks{}, pairs.kernel());
  const Real scale = BracedPairs::time / BracedPairs::dt * on_host(pairs.set().stiffness)[0];
  for (Index j = 0; j < 4; ++j) CHECK(norm(pairs.corner(0, j)) < 1e-15 * scale);
}

TEST_CASE("a broken point has no dashpot, and lanes give the bits of one by one") {
  constexpr Index several = 2 * lanes + 3;
  BracedPairs in_lanes(several), one_by_one(several);
  for (BracedPairs* pairs : {&in_lanes, &one_by_one}) {
    Random random(2);
    for (Index p = 0; p < several; ++p) {
      on_host(pairs->state.quads.status)[p] = p % 3 == 2 ? 0 : 1;
      on_host(pairs->state.quads.bond)[p] = p % 2;  // of the first point
    }
    for (Real& f : pairs->force) f = random.between(-1, 1);
    for (Index i = 0; i < pairs->model.node_count; ++i)
      put(pairs->motion(i) + 4, random.vector(1e-3));
    pairs->advance();
  }
  for_each_lane({}, several, Blocks{}, in_lanes.kernel());
  for (Index p = 0; p < several; ++p) one_by_one.kernel()(One{p});
  CHECK(in_lanes.force == one_by_one.force);
  CHECK(in_lanes.work == one_by_one.work);
  for (Index p = 0; p < several; ++p) {
    const bool live = p % 3 != 2, holds = p % 2 == 1;
    if (live) CHECK((in_lanes.force[p] == 0) == !holds);
    for (Index k = 0; k < 4; ++k) CHECK(norm(in_lanes.corner(p, k) - one_by_one.corner(p, k)) == 0);
  }
}

}  // namespace cdem::test
