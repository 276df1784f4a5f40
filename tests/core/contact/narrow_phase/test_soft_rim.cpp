// Soft contacts stay on a face whose rim their vertex has passed.
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/soft_rim.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A cube on an equal one, pressed a little into it and moved over its rim.
struct TwoCubes : Scene {
  Index mother = -1, corner = -1, target = -1;  // of the upper cube, at (1, 0, 1); top of the lower

  TwoCubes() {
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({0, 0, 1}, {1, 1, 1});
    build();
    start();
    move({0, 0, 0});
    const Index exposed = Index(state.search.exposed_face.size());
    const FaceGeometry geometry = face_geometry(state);
    for (Index x = 0; x < exposed; ++x) {
      if (std::abs(geometry.center(x).z - 1) > 0.1) continue;
      (geometry.normal(x).z > 0 ? target : mother) = x;
    }
    for (Index k = 0; k < 4; ++k)
      if (distance(position(vertex(k)), {1, 0, 1}) < 0.1) corner = k;
    first_.resize(4 * std::size_t(exposed) + 1, 0);
    state.springs.unresolved.resize(4 * std::size_t(exposed));
  }
  /// Move the upper cube as a whole, turned about y by a small angle.
  void move(const Vec& by, Real angle = 0) {
    for (Index i = 8; i < 16; ++i) {
      const Vec x = position(i) + by;
      put(motion(i), Vec{x.x + angle * (x.z - 1), x.y, x.z - angle * (x.x - 0.5)});
    }
    state.dt_last = 1e-3;
    update_all_face_geometry(model, state, {});
  }
  /// Is the corner still in contact, if it was and has given so much in shear  [m]?
  bool holds(Real given) {
    const FaceSearch search = face_search(model, state);
    const Index slot = 4 * mother + corner;
    ContactState{.force_n = 1000,
                 .penetration = 1e-4,
                 .shear1 = 30,
                 .shear2 = 40,
                 .stress_free_gap = 0,
                 .energy_n = 0.05,
                 .energy_s = 0.5 * 50 * given}
        .store(search.springs.state, slot);
    search.springs.target[slot] = target;
    for_each_item({}, mother + 1, BeginTargets{search.springs});
    ResolveTargets resolve{search};
    resolve.candidates.first = first_.data();
    search.springs.unresolved[slot] = 1;
    resolve.resolve(mother, corner);
    HoldAtRims{search}(One{mother});
    return search.springs.target[slot] == target;
  }
  Real action() const { return on_host(state.springs.rim_action)[4 * mother + corner]; }
  /// The indentation of a face of the cubes  [m].
  Real indented() const { return model.rules.indentation * on_host(model.face_length)[0]; }

 private:
  std::vector<Index> first_;
  Index vertex(Index k) const { return on_host(state.search.exposed)[mother].corner[k]; }
};

}  // namespace

TEST_CASE("a soft contact is held at the rim that its vertex has passed, and acts there") {
  TwoCubes cubes;
  const Real soft = 0.31 * cubes.indented(), stiff = 0.29 * cubes.indented();
  cubes.move({0.004, 0, -1e-4});  // P is still over the target
  CHECK(cubes.holds(stiff));
  CHECK(cubes.action() == 0);
  cubes.move({0.016, 0, 0});  // 0.02 beyond the rim, of 0.5 to the centre: P of 0.04 is at the rim
  CHECK(cubes.holds(soft));
  CHECK(std::abs(cubes.action() - 0.03) < 1e-12);
  CHECK(!cubes.holds(stiff));
  CHECK(cubes.action() == 0);
  cubes.model.rules.action = cubes.model.rules.indentation;
  CHECK(cubes.holds(soft));
  CHECK(std::abs(cubes.action() - 0.04) < 1e-12);
}

TEST_CASE("a contact is held past two rims at once, to nine tenths of the way to the centre") {
  TwoCubes cubes;
  const Real soft = cubes.indented();
  cubes.move({0.02, -0.1, -1e-4});
  CHECK(cubes.holds(soft));
  CHECK(std::abs(cubes.action() - 0.19) < 1e-12);
  cubes.move({0, -0.34, 0});
  CHECK(cubes.holds(soft));
  cubes.move({0, -0.02, 0});
  CHECK(!cubes.holds(soft));
  cubes.move({0.48, 0, 0});  // the centre is outside
  CHECK(!cubes.holds(soft));
}

TEST_CASE("a contact over a rim ends where the faces part or do not lie on each other") {
  TwoCubes lifted, tilted;
  lifted.move({0.02, 0, 1e-4});
  CHECK(!lifted.holds(lifted.indented()));
  tilted.move({0.02, 0, -1e-4}, 0.02);
  CHECK(tilted.holds(tilted.indented()));
  tilted.move({0, 0, 0}, 0.06);
  CHECK(!tilted.holds(tilted.indented()));
}

}  // namespace cdem::test
