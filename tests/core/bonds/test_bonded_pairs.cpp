// Bonds of conforming pairs: forces on both sides, history, release of lanes.
#include "core/base/parallel.hpp"
#include "core/bonds/bonded_pairs.hpp"
#include "core/bonds/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Pairs of boxes bonded along a side, one pair a column, far apart; or pairs of wedges bonded by
/// their triangles.
template <Index count>
struct Pairs : Scene {
  Real indentation = 0.3;

  explicit Pairs(Index pairs, Random& random, Real shake = 0) {
    bonded = true;
    for (Index p = 0; p < pairs; ++p) {
      const Vec at{4.0 * p, 0, 0};
      if constexpr (count == 4) {
        add_box(at, {1, 1, 1});
        add_box(at + Vec{0, 0, 1}, {1, 1, 1});
      } else {
        std::array<Vec, 6> x = Reference<Wedge6>::corners();
        for (Vec& c : x) c = c + at;
        add<Wedge6>(x);
        for (Vec& c : x) c = c + Vec{0, 0, 2};
        add<Wedge6>(x);
      }
    }
    build();
    set_interface({{"cohesion", 1e5}, {"tensile_strength", 1e5}, {"friction_angle", 0.5}});
    for (Index i = 0; i < model.node_count; ++i) {
      put(motion(i), position(i) + random.vector(shake));
      put(motion(i) + 4, random.vector(shake));
    }
  }
  const PairSet& set() const { return count == 4 ? model.quads : model.triangles; }
  PairState& pairs() { return count == 4 ? state.quads : state.triangles; }
  WithLaws<ConformingBonds<count>, BrittleAlone> kernel() {
    return {{.nodes = {state.nodes.motion.data()},
             .pair_nodes = {set().nodes.data(), set().stride},
             .pairs = pair_columns(model, set(), pairs()),
             .indentation = indentation,
             .dt = 1e-3,
             .sampled = true,
             .corner_force = {state.corner_force.data() + std::size_t(set().corner_first) * 4}}};
  }
  Vec force(Index pair, Index k) const {
    return vector_at(state.corner_force.data() + 4 * (set().corner_first + pair * count + k));
  }
  Index node(Index pair, Index k) const { return on_host(set().nodes)[k * set().stride + pair]; }
};

}  // namespace

TEST_CASE_TEMPLATE("a rigid motion of a pair gives no force", Scene, Pairs<3>, Pairs<4>) {
  Random random(1);
  Scene pairs(lanes + 1, random);
  const Mat turn = random.rotation();
  for (Index i = 0; i < pairs.model.node_count; ++i)
    put(pairs.motion(i), turn * pairs.position(i) + Vec{1, 2, 3});
  for_each_lane({}, pairs.set().count, Blocks{}, pairs.kernel());
  const Real stiffness = on_host(pairs.set().stiffness)[0];
  for (Index p = 0; p < pairs.set().count; ++p)
    for (Index k = 0; k < 3; ++k) CHECK(norm(pairs.force(p, k)) < 1e-14 * stiffness);
}

TEST_CASE_TEMPLATE("a pair that is pulled bears stiffness times area times opening", Scene,
                   Pairs<3>, Pairs<4>) {
  Random random(2);
  Scene pairs(1, random);
  const Index count = pairs.set().points;
  const Vec jump{3e-5, 2e-5, 1e-4};
  for (Index k = 0; k < count; ++k) {
    Real* mate = pairs.motion(pairs.node(0, count + k));
    put(mate, vector_at(mate) + jump);
  }
  for_each_lane({}, 1, Blocks{}, pairs.kernel());
  Vec sum{0, 0, 0};
  for (Index k = 0; k < count; ++k) sum = sum + pairs.force(0, k);
  const Real k = on_host(pairs.set().stiffness)[0] * on_host(pairs.set().area)[0];
  CHECK(distance(sum, Real(-k) * jump) < 1e-12 * k * norm(jump));
  CHECK(relative_error(on_host(pairs.pairs().stored)[0], 0.5 * k * dot(jump, jump)) < 2e-12);
}

TEST_CASE_TEMPLATE("pairs give the same bits one by one and in lanes, broken or not", Scene,
                   Pairs<3>, Pairs<4>) {
  const auto fill = [](Scene& pairs) {
    for (Index p = 0; p < pairs.set().count; ++p)
      on_host(pairs.pairs().status)[p] = p % 4 == 3 ? 0 : p % 3 == 2 ? 2 : 1;
  };
  Random random(3), again(3);
  constexpr Index several = 8 + 2 * lanes + 3;
  Scene in_lanes(several, random, 0.005), one_by_one(several, again, 0.005);
  fill(in_lanes);
  fill(one_by_one);
  const Index count = in_lanes.set().count;
  for (int n = 0; n < 3; ++n) {
    for_each_lane({}, count, Blocks{}, in_lanes.kernel());
    for (Index p = 0; p < count; ++p) one_by_one.kernel()(One{p});
    for (Index i = 0; i < in_lanes.model.node_count; ++i) {
      const Vec shift = random.vector(0.002);
      put(in_lanes.motion(i), in_lanes.position(i) + shift);
      put(one_by_one.motion(i), one_by_one.position(i) + shift);
    }
  }
  PairState &a = in_lanes.pairs(), &b = one_by_one.pairs();
  const PairSet& set = in_lanes.set();
  for (Index p = 0; p < count; ++p) {
    if (on_host(a.status)[p] == 0) continue;  // one by one, a released pair writes nothing
    for (Index k = 0; k < set.points; ++k) {
      const std::size_t row = std::size_t(k) * set.point_stride + p;
      CHECK(same_bits(on_host(a.bond)[row], on_host(b.bond)[row]));
      CHECK(same_bits(on_host(a.slip1)[row], on_host(b.slip1)[row]));
      CHECK(distance(in_lanes.force(p, k), one_by_one.force(p, k)) == 0);
    }
    for (Column<Real> PairState::* column :
         {&PairState::stored, &PairState::fracture, &PairState::friction, &PairState::jump,
          &PairState::broken_shear, &PairState::broken_tension})
      CHECK(same_bits(on_host((a.*column))[p], on_host((b.*column))[p]));
  }
  Real broken = 0, intact = 0;
  for (Index p = 0; p < count; ++p)
    for (Index k = 0; k < set.points; ++k)
      (on_host(a.bond)[std::size_t(k) * set.point_stride + p] > 0 ? intact : broken) += 1;
  CHECK(broken > 5);
  CHECK(intact > 5);
}

TEST_CASE("a released pair exerts nothing and keeps its history") {
  Random random(4);
  Pairs<4> pairs(1, random, 0.01);
  on_host(pairs.pairs().status)[0] = 0;
  for_each_lane({}, 1, Blocks{}, pairs.kernel());
  for (Index k = 0; k < 4; ++k) {
    CHECK(norm(pairs.force(0, k)) == 0);
    CHECK(on_host(pairs.pairs().bond)[k * pairs.set().point_stride] == 1);
  }
}

TEST_CASE("the frame of a pair points from the first face into the second") {
  Random random(5);
  const Pairs<4> pairs(1, random);
  Vec mean[4];
  for (Index k = 0; k < 4; ++k) mean[k] = pairs.position(pairs.node(0, k));
  const Frame<Real> frame = pair_frame<4>(mean);
  CHECK(distance(frame.n, Vec{0, 0, 1}) < 1e-15);
  CHECK(distance(cross(frame.n, frame.t1), frame.t2) < 1e-15);
}

TEST_CASE("bond points lie between the vertices and the centre") {
  Vec values[3] = {{3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
  move_inside<3>(0.0, values);
  CHECK(values[0].x == 3);
  move_inside<3>(0.5, values);
  CHECK(distance(values[0], Vec{2, 0.5, 0.5}) < 1e-15);
  move_inside<3>(1.0, values);
  CHECK(distance(values[2], Vec{1, 1, 1}) < 1e-15);
}

}  // namespace cdem::test
