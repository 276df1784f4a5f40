// Where the nodes of exposed faces go until the lists are made again.
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

struct Flying : Scene {
  Flying() {
    Random random(1);
    add_tet(random, {0, 0, 0}, 1);
    build();
    set_motion(0, {1, 2, 3}, {4, 5, 6});
    start();
    state.dt = 1e-3;
  }
  PredictedNode predicted(Index node) const { return predicted_nodes(state).at(node); }
};

}  // namespace

TEST_CASE("a rigid block is predicted where its nodes go; a vibration is left out") {
  Flying tet;
  predict_motion(tet.model, tet.state);
  for (Index i = 0; i < 4; ++i) {
    CHECK(distance(tet.predicted(i).position, tet.position(i)) == 0);
    CHECK(distance(tet.predicted(i).velocity, tet.velocity(i)) < 1e-14);
  }
  // breathing about the centre is no rigid motion
  Vec center{0, 0, 0};
  for (Index i = 0; i < 4; ++i) center = center + Real(0.25) * tet.position(i);
  const Vec before = tet.velocity(2);
  for (Index i = 0; i < 4; ++i)
    put(tet.motion(i) + 4, tet.velocity(i) + (tet.position(i) - center));
  predict_motion(tet.model, tet.state);
  CHECK(distance(tet.predicted(2).velocity, before) < 2e-14);
}

TEST_CASE("a skin is the least of a calm node, a tenth of the smallest L of one that vibrates") {
  Flying tet;
  // the smallest L of the faces at a node
  Real length[4] = {1e300, 1e300, 1e300, 1e300};
  for (Index f = 0; f < 4; ++f)
    for (Index k = 0; k < 3; ++k) {
      Real& least = length[on_host(tet.model.face_nodes)[4 * f + k]];
      least = std::min(least, on_host(tet.model.face_length)[f]);
    }
  predict_motion(tet.model, tet.state);
  for (Index i = 0; i < 4; ++i)
    CHECK(tet.predicted(i).skin == tet.state.search.outer.least_skin * length[i]);
  for (Index i = 0; i < 4; ++i) tet.motion(i)[4] += i % 2 ? 1000 : -1000;
  predict_motion(tet.model, tet.state);
  for (Index i = 0; i < 4; ++i) CHECK(tet.predicted(i).skin == 0.1 * length[i]);
}

TEST_CASE("a node has left its skin when it is off its way, not while it follows it") {
  Flying tet;
  tet.state.search.outer.lookahead_time = 0.1;
  predict_motion(tet.model, tet.state);
  const Column<Real>& list = tet.state.search.outer.predicted;
  const Real horizon = tet.state.search.outer.lookahead_time, built = tet.state.time;
  REQUIRE(horizon > 0);
  std::vector<Vec> start, way;
  for (Index i = 0; i < 4; ++i) {
    start.push_back(tet.position(i));
    way.push_back(tet.predicted(i).velocity);
  }
  const auto exceeds = [&](Real time, const Vec& off) {
    for (Index i = 0; i < 4; ++i)
      put(tet.motion(i), start[i] + time * way[i] + (i == 2 ? off : Vec{0, 0, 0}));
    tet.state.time = built + time;
    Answer<Flag> exceeds;
    exceeds.set({}, 0);
    ask_if_skin_is_exceeded(tet.state, list, built, horizon, exceeds.data());
    return exceeds.read({}) != 0;
  };
  const Real skin = tet.predicted(2).skin;
  CHECK(!exceeds(0, {0, 0, 0}));
  CHECK(!exceeds(0.5 * horizon, {0.99 * skin, 0, 0}));
  CHECK(exceeds(0.5 * horizon, {0, 1.01 * skin, 0}));
  CHECK(exceeds(1.5 * horizon, {0, 0, 0}));  // the lists have looked no farther
}

TEST_CASE("a predicted node is read back from its row") {
  Flying tet;
  predict_motion(tet.model, tet.state);
  const PredictedNode node{{1, 2, 3}, {4, 5, 6}, 0.5};
  node.store(on_host(tet.state.search.outer.predicted).data() +
             8 * on_host(tet.state.search.outer.node_predicted)[1]);
  CHECK(distance(tet.predicted(1).position, node.position) == 0);
  CHECK(distance(tet.predicted(1).velocity, node.velocity) == 0);
  CHECK(tet.predicted(1).skin == 0.5);
}

}  // namespace cdem::test
