// The return to planes in principal stress: every set of active planes is needed.
#include "core/materials/principal_planes.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

// N = 3, M = 2, c such that the strength is 1 Pa; lambda = mu = 1 Pa
const PrincipalPlanes<Real> planes{.slope = 1.0 / 3, .flow_slope = 0.5, .strength = 1, .cut = 0.6};

Vec stress_of(const Real* strain) {
  const Real pressure = strain[0] + strain[1] + strain[2];
  return {pressure + 2 * strain[0], pressure + 2 * strain[1], pressure + 2 * strain[2]};
}

}  // namespace

TEST_CASE("a stress that was pushed out along the flow of some planes comes back") {
  // corners and edges of the yield surface, and the strains of the planes that meet there
  const Real shear13[] = {1, 0, -0.5}, shear23[] = {0, 1, -0.5}, shear12[] = {1, -0.5, 0};
  const Real pull1[] = {1, 0, 0}, pull2[] = {0, 1, 0}, pull3[] = {0, 0, 1};
  const struct {
    Vec at;
    std::vector<const Real*> flows;
  } cases[] = {
      {{0, -1, -3}, {shear13}},
      {{0, 0, -3}, {shear13, shear23}},
      {{0, -3, -3}, {shear13, shear12}},
      {{0.6, 0.2, 0}, {pull1}},
      {{0.6, 0.6, 0}, {pull1, pull2}},
      {{0.6, 0.6, 0.6}, {pull1, pull2, pull3}},
      {{0.6, 0, -1.2}, {shear13, pull1}},
      {{0.6, -1.2, -1.2}, {shear13, shear12, pull1}},
      {{0.6, 0.6, -1.2}, {shear13, pull1, pull2}},
      {{0.6, 0.6, -1.2}, {shear13, shear23, pull1}},
  };
  for (const auto& one : cases) {
    CHECK(std::abs(planes.outside(one.at)) < 1e-15);
    Real pushed[3] = {};
    for (std::size_t i = 0; i < one.flows.size(); ++i)
      for (Index k = 0; k < 3; ++k) pushed[k] += (0.3 + 0.1 * Real(i)) * one.flows[i][k];
    const auto back = planes.bring_back(1, 1, one.at + stress_of(pushed), 1e-12);
    for (Index k = 0; k < 3; ++k) CHECK(std::abs(back.strain[k] - pushed[k]) < 2e-15);
  }
}

TEST_CASE("outside is how far the farthest plane is passed") {
  CHECK(planes.outside({0.7, 0, 0}) == doctest::Approx(0.1));
  CHECK(planes.outside({0, -1, -4.5}) == doctest::Approx(0.5));
  CHECK(planes.outside({0, 0, 0}) == doctest::Approx(-0.6));
}

}  // namespace cdem::test
