// What stops a run that went wrong.
#include <limits>

#include "core/diagnostics/health.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

struct Box : Scene {
  Box() {
    add_box({0, 0, 0}, {1, 1, 1});
    build();
    start();
  }
  Report health() const { return check_health(model, state); }
};

}  // namespace

TEST_CASE("a healthy state goes on") {
  const Box box;
  CHECK(box.health().outcome == Outcome::steps_done);
  CHECK(box.health().culprit == -1);
}

TEST_CASE("a node whose place or velocity is no number is named") {
  for (const Index component : {0, 2, 4, 6})
    for (const Real bad :
         {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
      Box box;
      box.motion(5)[component] = bad;
      CHECK(box.health().outcome == Outcome::not_finite);
      CHECK(box.health().culprit == 5);
    }
}

TEST_CASE("the fastest node is named when it is too fast") {
  Box box;
  box.motion(3)[5] = -9;
  box.motion(6)[4] = 11;
  CHECK(box.health().outcome == Outcome::steps_done);
  box.model.speed_limit = 12;
  CHECK(box.health().outcome == Outcome::steps_done);
  box.model.speed_limit = 10;
  const Report report = box.health();
  CHECK(report.outcome == Outcome::too_fast);
  CHECK(report.culprit == 6);
  CHECK(report.value == 11);
}

TEST_CASE("a node with a scaled mass is too fast if its energy is") {
  Box box;
  box.model.speed_limit = 10;
  box.motion(3)[5] = 1000;
  box.state.nodes.relax_mass.assign(box.model.mass.data(), box.model.node_count);
  on_host(box.state.nodes.relax_mass)[3] *= 0.99e-4;
  CHECK(box.health().outcome == Outcome::steps_done);
  on_host(box.state.nodes.relax_mass)[3] *= 1.03;
  CHECK(box.health().outcome == Outcome::too_fast);
}

TEST_CASE("a contact that penetrated too deep is named by its face") {
  Box box;
  on_host(box.state.springs.lost)[4 * 2 + 3] = 1;
  CHECK(box.health().outcome == Outcome::lost_contact);
  CHECK(box.health().culprit == 2);
  Box other;
  on_host(other.state.edges.lost)[4] = 1;
  CHECK(other.health().outcome == Outcome::lost_contact);
  CHECK(other.health().culprit == 4);
}

}  // namespace cdem::test
