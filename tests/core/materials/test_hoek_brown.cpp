// Hoek-Brown: constants of a rock mass, the curve, its tension, strength factor, lanes.
#include <string>

#include "core/materials/hoek_brown.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

using Said = std::array<Real, 10>;

HoekBrown<Real> law_of_case(Said said) {
  said[7] = std::tan(said[7] * M_PI / 180);
  const auto numbers = HoekBrown<Real>::prepare(said.data());
  return HoekBrown<Real>::read([&](Index k) { return numbers[k]; });
}
constexpr Real no = unlimited;
/// s_ci 30 MPa, GSI 50, m_i 10, D 0.
const Said rock{30, 50, 10, 0, no, no, no, 0, no, 1};

Real curve(const HoekBrown<Real>& law, Real s3) {
  const Real x = std::max(law.m * s3 / law.uniaxial_strength + law.s, 0.0);
  return s3 + law.uniaxial_strength * std::pow(x, law.a);
}

Sym3<Real> random_stress(Random& random) {
  const Real mean = random.between(-30, 5);
  return symmetric(random.matrix(25)) + Sym3<Real>{mean, mean, mean, 0, 0, 0};
}

}  // namespace

TEST_CASE("constants of a rock mass are those of Hoek and Brown") {
  const HoekBrown<Real> law = law_of_case(rock);
  CHECK(relative_error(law.m, 1.676772) < 1e-6);
  CHECK(relative_error(law.s, 3.865920e-3) < 1e-6);
  CHECK(relative_error(law.a, 0.505734) < 1e-6);
  CHECK(relative_error(law.tensile_strength, 0.069167) < 1e-5);
}

TEST_CASE("strength under pressure is that of the curve") {
  const ElasticConstants<Real> elastic{4e3, 4e3};
  const Real known[][2] = {{0, 1.806817}, {1, 8.216139}, {5, 20.853519}, {20, 51.794235}};
  const HoekBrown<Real> law = law_of_case(rock);
  for (const auto& [s3, s1] : known) {
    CHECK(relative_error(curve(law, s3), s1) < 1e-6);
    for (const Real part : {0.99999, 1.00001}) {
      Real state[2] = {};
      const auto flow = law.flow(elastic, {-s3, -s3, -s1 * part, 0, 0, 0}, state);
      CHECK((contract(flow, flow) > 0) == (part > 1));
    }
  }
}

TEST_CASE("a returned stress lies on the curve, and flow spends energy") {
  Random random(1);
  const ElasticConstants<Real> elastic{4e3, 4e3};
  for (const Said& said : {rock, Said{30, 20, 5, 0.5, no, no, no, 0, no, 1},
                           Said{80, no, no, 0, 15, 1, 0.5, 20, 1, 1}}) {
    const HoekBrown<Real> law = law_of_case(said);
    Real outside = 0, at_apex = 0, made = 0;
    int flowed = 0;
    for (int k = 0; k < 3000; ++k) {
      const Sym3<Real> trial = random_stress(random);
      Real state[2] = {};
      const auto flow = law.flow(elastic, trial, state);
      const auto p = principal_axes(trial - elastic.stress(flow)).value;
      // in tension, near the apex, where the curve is vertical, a tangent stands for it
      Real& worst = p.x > 0 ? at_apex : outside;
      worst = std::max(worst, -p.z - curve(law, -p.x));
      at_apex = std::max(at_apex, p.x - law.tensile_strength);
      made = std::max(made, -contract(trial - elastic.stress(flow), flow));
      flowed += state[0] + state[1] > 0;
    }
    CHECK(outside < 1e-6 * law.uniaxial_strength);
    CHECK(at_apex < 5e-3 * law.uniaxial_strength);
    CHECK(made < 1e-12);
    CHECK(flowed > 1000);
  }
}

TEST_CASE("what is taken for elastic without its principal values does not flow") {
  Random random(2);
  const ElasticConstants<Real> elastic{4e3, 4e3};
  for (const Said& said : {rock, Said{30, 20, 5, 0.5, no, no, no, 0, no, 1}}) {
    const HoekBrown<Real> law = law_of_case(said);
    int surely = 0;
    for (int k = 0; k < 3000; ++k) {
      const Real mean = random.between(-60, 1), size = random.between(0, 15);
      const Sym3<Real> trial =
          symmetric(random.matrix(size)) + Sym3<Real>{mean, mean, mean, 0, 0, 0};
      if (!law.surely_elastic(trial)) continue;
      ++surely;
      Real state[2] = {};
      const auto flow = law.flow(elastic, trial, state);
      CHECK(contract(flow, flow) == 0);
    }
    CHECK(surely > 300);
  }
}

TEST_CASE("a strength factor divides cohesion and friction of the tangent") {
  const ElasticConstants<Real> elastic{4e3, 4e3};
  Said said = rock;
  said[9] = 2;
  const HoekBrown<Real> full_strength = law_of_case(rock), law = law_of_case(said);
  // the tangent at 5 MPa
  const Real s3 = 5, x = law.m * s3 / 30 + law.s, n = 1 + law.a * law.m * std::pow(x, law.a - 1);
  const Real strength = curve(full_strength, s3) - n * s3;
  const Real cohesion = strength / (2 * std::sqrt(n)) / 2;
  const Real t = (n - 1) / (2 * std::sqrt(n)) / 2, root = t + std::sqrt(1 + t * t);
  const Real s1 = root * root * s3 + 2 * cohesion * root;
  for (const Real part : {0.99999, 1.00001}) {
    Real state[2] = {};
    const auto flow = law.flow(elastic, {-s3, -s3, -s1 * part, 0, 0, 0}, state);
    CHECK((contract(flow, flow) > 0) == (part > 1));
  }
}

TEST_CASE("constants come from one of two sets") {
  const auto why = [](const Said& said) {
    const char* text = HoekBrown<Real>::contradiction(said.data());
    return std::string(text ? text : "");
  };
  CHECK(why(rock).empty());
  CHECK(why({30, no, no, 0, 1, 1, 0.5, 0, no, 1}).empty());
  CHECK(why({30, no, no, 0, 1, 1, no, 0, no, 1}).starts_with("give gsi and mi"));
  CHECK(why({30, 50, no, 0, no, no, no, 0, no, 1}).starts_with("give gsi and mi"));
  CHECK(why({30, 50, 10, 0, 1, no, no, 0, no, 1}).starts_with("give gsi and mi"));
  CHECK(why({30, no, no, 0.5, 1, 1, 0.5, 0, no, 1}).starts_with("give gsi and mi"));
}

TEST_CASE("flow of a lane of rock masses is that of its numbers") {
  Random random(3);
  check_lanes<13, 8>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const auto law = HoekBrown<T>::read([&](Index k) { return in[k]; });
        out[6] = out[7] = T(0.25);
        const auto e =
            law.flow({T(4e3), T(4e3)}, {in[7], in[8], in[9], in[10], in[11], in[12]}, out + 6);
        out[0] = e.xx, out[1] = e.yy, out[2] = e.zz, out[3] = e.xy, out[4] = e.yz, out[5] = e.zx;
      },
      [&](Real* in) {
        Said said = rock;
        said[1] = random.between(10, 100), said[2] = random.between(2, 30);
        said[7] = 0.1, said[9] = random.below(2) ? 1 : 1.3;
        const auto numbers = HoekBrown<Real>::prepare(said.data());
        std::copy(numbers.begin(), numbers.end(), in);
        const Sym3<Real> s = Real(random.below(2) ? 1 : 0.05) * random_stress(random);
        in[7] = s.xx, in[8] = s.yy, in[9] = s.zz, in[10] = s.xy, in[11] = s.yz, in[12] = s.zx;
      });
}

}  // namespace cdem::test
