// Resistance to rolling: a spring against rotation that slips at mu_r R F_n.
#include "core/contact/force/force.hpp"
#include "core/contact/force/rolling.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box that tilts about an edge as it comes down onto a large fixed one.
struct Tilting : Scene {
  Index box;

  explicit Tilting(Real resistance) {
    add_box({-1, -1, -1}, {2, 2, 1}, true);
    box = add_box({-0.5, -0.5, 0}, {1, 1, 1});
    build();
    set_interface({{"friction_angle", 0.5}});
    change_interface(0, [&](Interface& i) { i.rolling_resistance = resistance; });
    set_motion(box, {0, 0, -0.5}, {0, 0.2, 0});
    start();
  }
  Real radius() const { return std::cbrt(0.75 / M_PI); }
  std::vector<std::size_t> touching() const {
    std::vector<std::size_t> slots;
    for (std::size_t k = 0; k < state.springs.target.size(); ++k)
      if (on_host(state.springs.target)[k] >= 0) slots.push_back(k);
    return slots;
  }
};

}  // namespace

TEST_CASE("a rotation spring is elastic up to its limit, and its energies close") {
  Random random(1);
  RollingState s{0, 0, 0, 0, {0, 0, 0}};
  Real work = 0, friction = 0;
  constexpr Real stiffness = 2e5, limit = 30;
  const RollingCouple first = RollingCouple::of(s, stiffness, 1e-5, -2e-5, limit);
  CHECK(first.couple1 == doctest::Approx(-2));
  CHECK(first.couple2 == doctest::Approx(4));
  CHECK(std::abs(first.friction) < 1e-18);
  for (int k = 0; k < 500; ++k) {
    const Real turn1 = random.between(-2e-4, 2e-4), turn2 = random.between(-2e-4, 2e-4);
    const RollingCouple c = RollingCouple::of(s, stiffness, turn1, turn2, limit);
    work -= 0.5 * ((s.couple1 + c.couple1) * turn1 + (s.couple2 + c.couple2) * turn2);
    friction += c.friction;
    CHECK(std::hypot(c.couple1, c.couple2) < limit * (1 + 1e-14));
    s.couple1 = c.couple1, s.couple2 = c.couple2, s.energy = c.energy;
  }
  CHECK(friction > 0);
  CHECK(std::abs(work - s.energy - friction) < 1e-12 * work);
  const RollingCouple open = RollingCouple::of(s, stiffness, 0, 0, 0);
  CHECK(open.couple1 == 0);
  CHECK(open.friction == doctest::Approx(s.energy));
}

TEST_CASE("couples are no larger than mu_r R F_n, and act against the rotation") {
  constexpr Real resistance = 1e-4;
  Tilting tilting(resistance);
  int at_limit = 0;
  for (int n = 0; n < 30; ++n) {
    tilting.step(1);
    const State& s = tilting.state;
    for (const std::size_t slot : tilting.touching()) {
      const RollingState r = RollingState::at(s.springs.rolling.data(), slot);
      const Real limit =
          resistance * tilting.radius() * ContactState::at(s.springs.state.data(), slot).force_n;
      CHECK(norm(r.couple) < limit * (1 + 1e-12) + 1e-12);
      at_limit += norm(r.couple) > limit * (1 - 1e-12) && limit > 0;
    }
  }
  CHECK(at_limit > 0);
  Real friction = 0;
  for (std::size_t k = 0; k < tilting.state.springs.friction.size(); ++k)
    friction += on_host(tilting.state.springs.friction)[k];
  CHECK(friction > 0);
}

TEST_CASE("couples add no force and no moment to two bodies") {
  Tilting tilting(0.3);
  for (int n = 0; n < 20; ++n) {
    tilting.step(1);
    Vec force{0, 0, 0}, moment{0, 0, 0}, on_box{0, 0, 0};
    const State& s = tilting.state;
    for (Index x = 0; x < Index(s.search.exposed_face.size()); ++x) {
      const Index face = on_host(s.search.exposed_face)[x];
      for (Index k = 0; k < 4; ++k) {
        const Index node = on_host(tilting.model.face_nodes)[4 * face + k];
        const Vec f = vector_at(s.contact_force.data() + 4 * (4 * x + k));
        force = force + f;
        moment = moment + cross(tilting.position(node) - s.dt_last * tilting.velocity(node), f);
        if (on_host(tilting.model.face_block)[face] == tilting.box) on_box = on_box + f;
      }
    }
    CHECK(norm(force) < 1e-14 * (1 + norm(on_box)));
    CHECK(norm(moment) < 1e-14 * (1 + norm(on_box)));
  }
}

TEST_CASE(
    "a couple goes on on another face with no more energy than it had, and ends with its contact") {
  Tilting tilting(0.3);
  tilting.step(8);
  State& s = tilting.state;
  const auto slots = tilting.touching();
  REQUIRE(slots.size() > 0);
  const std::size_t slot = slots[0];
  const auto run = [&] {
    const UpdateRollingCouples kernel{.faces = face_columns(tilting.model, s),
                                      .geometry = face_geometry(s),
                                      .laws = contact_laws(tilting.model, s),
                                      .springs = spring_columns(s),
                                      .exposed_face = s.search.exposed_face.data(),
                                      .face_radius = tilting.model.face_radius.data(),
                                      .rows = s.springs.rolling.data()};
    kernel(One{Index(slot / 4)});
    return RollingState::at(s.springs.rolling.data(), slot);
  };
  for (Index i = 0; i < tilting.model.node_count; ++i) put(tilting.motion(i) + 4, Vec{0, 0, 0});
  RollingState held{0, 0, 1e-11, 1, {3, -4, 0}};  // of a stiffer spring
  held.store(s.springs.rolling.data(), slot);
  on_host(s.springs.friction)[slot] = 0;
  on_host(s.springs.target_before)[slot] = on_host(s.springs.target)[slot] == 1 ? 2 : 1;
  const RollingState moved = run();
  CHECK(relative_error(moved.energy, held.energy) < 1e-12);
  CHECK(relative_error(moved.couple.x * -4, moved.couple.y * 3) < 1e-12);
  CHECK(std::abs(on_host(s.springs.friction)[slot]) < 1e-12 * held.energy);
  on_host(s.springs.target_before)[slot] = on_host(s.springs.target)[slot];
  on_host(s.springs.target)[slot] = -1;
  const RollingState ended = run();
  CHECK(norm(ended.couple) == 0);
  CHECK(ended.energy == 0);
  CHECK(relative_error(on_host(s.springs.friction)[slot], held.energy) < 1e-12);
}

TEST_CASE("a resistance that a stage takes away lets go of what springs hold") {
  Tilting tilting(0.3);
  tilting.step(10);
  const auto held = [&] {
    Real sum = 0;
    for (std::size_t k = 0; k < tilting.state.springs.rolling.size(); ++k)
      sum += std::abs(on_host(tilting.state.springs.rolling)[k]);
    return sum;
  };
  CHECK(held() > 0);
  tilting.change_interface(0, [](Interface& i) { i.rolling_resistance = 0; });
  tilting.step(1);
  CHECK(held() == 0);
}

TEST_CASE("without rolling resistance nothing is kept") {
  Tilting tilting(0);
  tilting.step(10);
  CHECK(tilting.state.springs.rolling.size() == 0);
}

}  // namespace cdem::test
