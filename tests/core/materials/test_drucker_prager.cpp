// Drucker-Prager: which cone it is, the return, what it remembers, one number against a lane.
#include "core/materials/drucker_prager.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

Real tangent(Real degrees) { return std::tan(degrees * M_PI / 180); }

Sym3<Real> random_stress(Random& random) {
  const Real mean = random.between(-8, 8);
  return symmetric(random.matrix(4)) + Sym3<Real>{mean, mean, mean, 0, 0, 0};
}
Real mean_of(const Sym3<Real>& s) { return trace(s) / 3; }
Real root_j2(const Sym3<Real>& s) {
  const auto d = with_trace(s, 0.0);
  return std::sqrt(contract(d, d) / 2);
}

}  // namespace

TEST_CASE("the cones have the slopes and strengths that are known, for c 1 and phi 35") {
  const Real sine = std::sin(35 * M_PI / 180), three = std::sqrt(3);
  const Real inner = 6 * sine / (three * (3 + sine));
  const Real known[][2] = {
      {0.818871, 1.169468}, {inner, inner / tangent(35)}, {0.544497, 0.777623}};
  const ElasticConstants<Real> elastic{1000, 1000};
  for (Index match = 0; match < 3; ++match) {
    const DruckerPrager<Real> law{1, tangent(35), 0, unlimited, Real(match)};
    for (const Real pressure : {0.0, 3.0}) {
      Real state[2] = {};
      const Sym3<Real> trial = {-pressure, -pressure, -pressure, 20, 0, 0};
      const auto stress = trial - elastic.stress(law.flow(elastic, trial, state));
      CHECK(relative_error(root_j2(stress), known[match][1] + known[match][0] * pressure) < 1e-6);
      CHECK(std::abs(mean_of(stress) + pressure) < 1e-12);
    }
  }
}

TEST_CASE("the outer cone is Mohr-Coulomb's in triaxial compression") {
  const ElasticConstants<Real> elastic{1000, 1000};
  const DruckerPrager<Real> law{1, tangent(35), 0, unlimited, 0};
  for (const Real part : {0.99999, 1.00001}) {
    Real state[2] = {};
    const auto flow = law.flow(elastic, {0, 0, -3.84196 * part, 0, 0, 0}, state);
    CHECK((contract(flow, flow) > 0) == (part > 1));
  }
}

TEST_CASE("a returned stress lies on the cone or the cut-off, and flow spends energy") {
  Random random(1);
  Real outside = 0, made = 0;
  int pulled = 0;
  for (int k = 0; k < 20000; ++k) {
    const Real phi = random.below(5) ? random.between(1, 60) : 0, part = random.between(0, 1);
    const DruckerPrager<Real> law{random.between(0.1, 2), tangent(phi), part * tangent(phi),
                                  random.below(2) ? unlimited : random.between(0, 2),
                                  Real(random.below(3))};
    const ElasticConstants<Real> elastic{random.between(0, 900), random.between(100, 900)};
    const Sym3<Real> trial = random_stress(random);
    Real state[2] = {};
    const auto flow = law.flow(elastic, trial, state);
    const auto stress = trial - elastic.stress(flow);
    // yield function by a law that cannot flow twice
    Real none[2] = {};
    const auto again = law.flow(elastic, stress, none);
    outside = std::max(outside, std::sqrt(contract(again, again)) * 900);
    made = std::max(made, -contract(stress, flow) / std::sqrt(contract(flow, flow)));
    CHECK(state[0] >= 0);
    CHECK(state[1] >= 0);
    pulled += state[1] > 0;
  }
  CHECK(outside < 1e-10);
  CHECK(made < 1e-10);
  CHECK(pulled > 2000);
}

TEST_CASE("shear and tension of the cone are remembered apart, in measures that are known") {
  const ElasticConstants<Real> elastic{100, 100};
  const DruckerPrager<Real> law{1, 0, 0, 2, 2};  // plane strain, phi 0: sqrt(J2) = c
  Real slid[2] = {}, pulled[2] = {};
  law.flow(elastic, {0, 0, 0, 1.5, 0, 0}, slid);
  CHECK(relative_error(slid[0], 0.5 / 100 / std::sqrt(3)) < 1e-14);
  CHECK(slid[1] == 0);
  law.flow(elastic, {3, 3, 3, 0, 0, 0}, pulled);
  CHECK(relative_error(pulled[1], 3 * 1.0 / (3 * 100 + 2 * 100)) < 1e-14);
  CHECK(pulled[0] == 0);
}

TEST_CASE("flow of a lane of cones is that of its numbers") {
  Random random(3);
  check_lanes<11, 8>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const auto law = DruckerPrager<T>::read([&](Index k) { return in[k]; });
        out[6] = out[7] = T(0.25);
        const auto e =
            law.flow({T(700.0), T(600.0)}, {in[5], in[6], in[7], in[8], in[9], in[10]}, out + 6);
        out[0] = e.xx, out[1] = e.yy, out[2] = e.zz, out[3] = e.xy, out[4] = e.yz, out[5] = e.zx;
      },
      [&](Real* in) {
        in[0] = random.between(0.1, 2), in[1] = tangent(random.between(0, 60));
        in[2] = 0.5 * in[1], in[3] = random.below(2) ? unlimited : random.between(0, 2);
        in[4] = random.below(3);
        const Sym3<Real> s = Real(random.below(2) ? 1 : 0.1) * random_stress(random);
        in[5] = s.xx, in[6] = s.yy, in[7] = s.zz, in[8] = s.xy, in[9] = s.yz, in[10] = s.zx;
      });
}

}  // namespace cdem::test
