// Faces that let waves out.
#include "core/surface/quiet.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a quiet face has the impedance of its rock, and no traction of its own") {
  const Impedance z = Quiet<Real>::impedance(nullptr, {.normal = 8, .shear = 6});
  CHECK(z.normal == 8);
  CHECK(z.shear == 6);
  Random random(1);
  const SurfacePoint<Real> at{.position = random.vector(1),
                              .displacement = random.vector(1),
                              .velocity = random.vector(1),
                              .normal = random.direction(),
                              .factor = 1};
  CHECK(norm(Quiet<Real>::read([](Index) { return 1; }).respond(at, nullptr)) == 0);
}

}  // namespace cdem::test
