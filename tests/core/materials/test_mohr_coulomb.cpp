// Mohr-Coulomb: the exact return, what it spends and remembers, one number against a lane.
#include <limits>
#include <string>

#include "core/materials/mohr_coulomb.hpp"
#include "tests/core/materials/mohr_coulomb_oracle.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

Real tangent(Real degrees) { return std::tan(degrees * M_PI / 180); }

/// A law and elastic constants drawn at random.
struct Rock {
  MohrCoulomb<Real> law;
  ElasticConstants<Real> elastic;

  explicit Rock(Random& random) {
    const Real phi = random.below(6) == 0 ? 0 : random.between(1, 60);
    const Real part[] = {0, 0.5, 1};
    law.cohesion = phi > 0 && random.below(6) == 0 ? 0 : random.between(0.1, 2);
    law.tan_friction = tangent(phi);
    law.tan_dilation = part[random.below(3)] * law.tan_friction;
    law.tensile_strength = random.below(3) == 0 ? unlimited : random.between(0, 1);
    const Real young = random.between(10, 1000), nu = random.between(0, 0.45);
    elastic = {young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))};
  }
  /// By how much a stress with these principal values exceeds the yield stress  [Pa].
  Real outside(const Vec& s) const {
    const Real t = law.tan_friction, root = t + std::sqrt(1 + t * t);
    Real cut = law.tensile_strength;
    if (t > 0) cut = std::min(cut, law.cohesion / t);
    return std::max(s.x - s.z / (root * root) - 2 * law.cohesion / root, s.x - cut);
  }
};

Sym3<Real> random_stress(Random& random) {
  const Real mean = random.between(-8, 8);
  return symmetric(random.matrix(4)) + Sym3<Real>{mean, mean, mean, 0, 0, 0};
}

Mat turned(const Mat& r, const Sym3<Real>& a) { return r * full(a) * transpose(r); }

}  // namespace

TEST_CASE("the return is that of a search over all sets of planes") {
  Real worst = 0;
  int yielded = 0;
  for (const MohrCoulombReturn& known : mohr_coulomb_returns) {
    const MohrCoulomb<Real> law{.cohesion = 1,
                                .tan_friction = tangent(known.phi),
                                .tan_dilation = tangent(known.psi),
                                .tensile_strength = known.tension < 0 ? unlimited : known.tension};
    const ElasticConstants<Real> elastic{known.lambda, known.mu};
    const Sym3<Real> trial{known.trial[0], known.trial[1], known.trial[2], 0, 0, 0};
    Real state[2] = {};
    const Sym3<Real> stress = trial - elastic.stress(law.flow(elastic, trial, state));
    worst = std::max(worst, distance(Vec{stress.xx, stress.yy, stress.zz}, vector_at(known.at)));
    yielded += state[0] + state[1] > 0;
  }
  CHECK(worst < 3e-11);
  CHECK(yielded > 250);
}

TEST_CASE("a returned stress lies on the yield surface, and the flow spends energy") {
  Random random(1);
  Real outside = 0, made = 0;
  for (int k = 0; k < 20000; ++k) {
    const Rock rock(random);
    const Sym3<Real> trial = random_stress(random);
    Real state[2] = {};
    const Sym3<Real> increment = rock.law.flow(rock.elastic, trial, state);
    const Sym3<Real> stress = trial - rock.elastic.stress(increment);
    outside = std::max(outside, rock.outside(principal_axes(stress).value));
    made = std::max(made, -contract(stress, increment) / std::sqrt(contract(increment, increment)));
    CHECK(state[0] >= 0);
    CHECK(state[1] >= 0);
    const bool yields = rock.outside(principal_axes(trial).value) > 1e-10;
    CHECK((contract(increment, increment) > 0) == yields);
  }
  CHECK(outside < 1e-10);
  CHECK(made < 1e-11);
}

TEST_CASE("the flow turns with the stress") {
  Random random(2);
  Real worst = 0;
  for (int k = 0; k < 1000; ++k) {
    const Rock rock(random);
    const Sym3<Real> trial = random_stress(random);
    const Mat r = random.rotation();
    Real state[2] = {}, state_turned[2] = {};
    const Mat increment = turned(r, rock.law.flow(rock.elastic, trial, state));
    const Sym3<Real> other = rock.law.flow(rock.elastic, symmetric(turned(r, trial)), state_turned);
    worst = std::max(worst, rock.elastic.mu * distance(increment, full(other)));
  }
  CHECK(worst < 1e-12 * 10);  // of stresses of about 10 Pa
}

TEST_CASE("shear and tension are remembered apart, in measures that are known") {
  const ElasticConstants<Real> elastic{100, 100};
  const MohrCoulomb<Real> law{
      .cohesion = 1, .tan_friction = 0, .tan_dilation = 0, .tensile_strength = 2};
  Real state[2] = {};
  // pure shear of 1.5 c: the angle 0.5 c / mu goes into flow, sqrt(2/3 s:s) = angle / sqrt(3)
  law.flow(elastic, {0, 0, 0, 1.5, 0, 0}, state);
  CHECK(relative_error(state[0], 0.5 / 100 / std::sqrt(3)) < 1e-14);
  CHECK(state[1] == 0);
  // equal tension of 3 Pa: 1 Pa over 3 K in each direction
  Real pulled[2] = {};
  law.flow(elastic, {3, 3, 3, 0, 0, 0}, pulled);
  CHECK(relative_error(pulled[1], 3 * 1.0 / (3 * 100 + 2 * 100)) < 1e-14);
  CHECK(pulled[0] == 0);
}

TEST_CASE("the tension cut-off is never beyond the apex") {
  const ElasticConstants<Real> elastic{100, 100};
  for (const Real tension : {10.0, unlimited}) {
    const MohrCoulomb<Real> law{
        .cohesion = 1, .tan_friction = 0.5, .tan_dilation = 0, .tensile_strength = tension};
    Real state[2] = {};
    const Sym3<Real> trial{9, 8, 7, 0, 0, 0};
    const Sym3<Real> stress = trial - elastic.stress(law.flow(elastic, trial, state));
    CHECK(distance(full(stress), Real(2) * identity<Real>()) < 1e-14);
  }
}

TEST_CASE("contradictions are told") {
  const auto why = [](Real c, Real phi, Real psi) {
    const Real parameter[] = {c, phi, psi, unlimited};
    const char* text = MohrCoulomb<Real>::contradiction(parameter);
    return std::string(text ? text : "");
  };
  CHECK(why(1, 0, 0).empty());
  CHECK(why(0, 0.5, 0.5).empty());
  CHECK(why(1, 0.5, 0.6).starts_with("dilation_angle must not be larger"));
  CHECK(why(0, 0, 0).starts_with("cohesion and friction_angle must not both be 0"));
}

TEST_CASE("flow of a lane is that of its numbers") {
  Random random(3);
  check_lanes<12, 8>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const auto law = MohrCoulomb<T>::read([&](Index k) { return in[k]; });
        const ElasticConstants<T> elastic{in[4], in[5]};
        out[6] = out[7] = T(0.25);
        const auto e = law.flow(elastic, {in[6], in[7], in[8], in[9], in[10], in[11]}, out + 6);
        out[0] = e.xx, out[1] = e.yy, out[2] = e.zz, out[3] = e.xy, out[4] = e.yz, out[5] = e.zx;
      },
      [&](Real* in) {
        const Rock rock(random);
        in[0] = rock.law.cohesion, in[1] = rock.law.tan_friction, in[2] = rock.law.tan_dilation;
        in[3] = rock.law.tensile_strength;
        in[4] = rock.elastic.lambda, in[5] = rock.elastic.mu;
        const Sym3<Real> s = Real(random.below(2) ? 1 : 0.1) * random_stress(random);
        in[6] = s.xx, in[7] = s.yy, in[8] = s.zz, in[9] = s.xy, in[10] = s.yz, in[11] = s.zx;
      });
}

}  // namespace cdem::test
