// One time step: flight, collision, and steps that do not depend on threads.
#include "core/base/openmp.hpp"
#include "core/step.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Linear momentum, and angular momentum about the origin, with the masses that move.
struct Momentum {
  Vec linear{0, 0, 0}, angular{0, 0, 0};
  explicit Momentum(const Scene& scene) {
    const Model& m = scene.model;
    for (Index i = 0; i < m.node_count; ++i) {
      Vec p = on_host(m.mass)[i] * scene.velocity(i);
      if (on_host(m.mass_row_first)[i] >= 0) {
        p = {0, 0, 0};
        for (Index j = 0; j < 4; ++j)
          p = p + on_host(m.mass)[i] * on_host(m.mass_matrix)[on_host(m.mass_row_first)[i] + j] *
                      scene.velocity(on_host(m.block_first)[i] + j);
      }
      linear = linear + p;
      angular = angular + cross(scene.position(i), p);
    }
  }
};

/// Blocks of all shapes that fly into each other.
struct Crash : Scene {
  Crash() {
    Random random(1);
    const auto moved = [&](auto corners, const Vec& to) {
      for (Vec& c : corners) c = Real(0.5) * c + to;
      return corners;
    };
    add<Hex8>(moved(Reference<Hex8>::corners(), {0, 0, 0}));
    add<Wedge6>(moved(Reference<Wedge6>::corners(), {1.2, 0.1, 0.1}));
    add<Pyramid5>(moved(Reference<Pyramid5>::corners(), {0.1, 1.2, -0.1}));
    add_tet(random, {0.1, 0.1, 1.4}, 0.8);
    build();
    set_interface({{"friction_angle", 0.4}});
    set_motion(0, {0, 0, 0}, {0, 0, 1});
    set_motion(1, {-3, 0, 0}, {1, 0, 0});
    set_motion(2, {0, -3, 0}, {0, 2, 0});
    set_motion(3, {0, 0, -3}, {1, 2, 3});
    start();
  }
};

}  // namespace

TEST_CASE("a block in flight follows its parabola") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  scene.model.gravity = {0, 0, -10};
  scene.set_motion(0, {1, 2, 3});
  scene.start();
  scene.step(1);
  // central differences put the velocity half a step ahead, exactly on the parabola
  const Vec start = scene.position(0);
  const Vec v = scene.velocity(0);
  const Real first = scene.state.time, dt = scene.state.dt;
  scene.step(100);
  const Real time = scene.state.time - first, half = 0.5 * dt;
  const Vec expected = start + time * (v + Real(half) * scene.model.gravity) +
                       Real(0.5 * time * time) * scene.model.gravity;
  CHECK(distance(scene.position(0), expected) < 5e-15);
}

TEST_CASE("a collision of blocks of all shapes keeps linear and angular momentum") {
  Crash crash;
  const Momentum before(crash);
  Index touching = 0;
  for (int n = 0; n < 300; ++n) {
    crash.step(1);
    for (std::size_t k = 0; k < crash.state.springs.target.size(); ++k)
      touching += on_host(crash.state.springs.target)[k] >= 0;
  }
  CHECK(touching > 30);
  const Momentum after(crash);
  CHECK(distance(after.linear, before.linear) < 3e-15 * 2500);
  CHECK(distance(after.angular, before.angular) < 2e-7 * 2500);
}

TEST_CASE("threads and the split into runs change no bit") {
  const int threads = omp_get_max_threads();
  std::vector<std::vector<Real>> motions;
  for (const int on : {1, 3}) {
    omp_set_num_threads(on);
    Crash crash;
    for (int n = 0; n < (on == 1 ? 1 : 20); ++n) crash.step(on == 1 ? 200 : 10);
    const Column<Real>& motion = crash.state.nodes.motion;
    motions.emplace_back(motion.data(), motion.data() + motion.size());
  }
  omp_set_num_threads(threads);
  CHECK(motions[0] == motions[1]);
}

}  // namespace cdem::test
