// Pressure that follows the face.
#include "core/surface/pressure.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("pressure acts against the normal, scaled by its history, whatever else the face does") {
  Random random(7);
  for (int round = 0; round < 20; ++round) {
    const SurfacePoint<Real> at{.position = random.vector(9),
                                .displacement = random.vector(9),
                                .velocity = random.vector(9),
                                .normal = random.direction(),
                                .factor = random.between(-1, 2)};
    const Real p = random.between(-5, 5);
    const auto law = Pressure<Real>::read([&](Index) { return p; });
    const Vec traction = law.respond(at, nullptr);
    CHECK(dot(traction, at.normal) == doctest::Approx(-p * at.factor).epsilon(1e-14));
    CHECK(norm(cross(traction, at.normal)) < 1e-14 * (1 + norm(traction)));
  }
}

}  // namespace cdem::test
