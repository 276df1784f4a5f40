// Isotropic elasticity: the stress of a known strain.
#include "core/materials/law.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

constexpr Real lambda = 3e9, mu = 5e9;
const ElasticConstants<Real> rock{lambda, mu};

}  // namespace

TEST_CASE("confined compression, pure shear and equal strain on all sides") {
  const Sym3<Real> confined = rock.stress({-1e-3, 0, 0, 0, 0, 0});
  CHECK(relative_error(confined.xx, -1e-3 * (lambda + 2 * mu)) < 1e-15);
  CHECK(relative_error(confined.yy, -1e-3 * lambda) < 1e-15);
  CHECK(confined.zz == confined.yy);
  CHECK(confined.xy == 0);
  const Sym3<Real> shear = rock.stress({0, 0, 0, 1e-3, 2e-3, 3e-3});
  CHECK(relative_error(shear.xy, 2 * mu * 1e-3) < 1e-15);
  CHECK(relative_error(shear.yz, 2 * mu * 2e-3) < 1e-15);
  CHECK(relative_error(shear.zx, 2 * mu * 3e-3) < 1e-15);
  CHECK(trace(shear) == 0);
  const Sym3<Real> all = rock.stress({1e-3, 1e-3, 1e-3, 0, 0, 0});
  CHECK(relative_error(trace(all), 3e-3 * (3 * lambda + 2 * mu)) < 1e-15);
}

TEST_CASE("a bar that is pulled has Young's modulus and narrows by Poisson's ratio") {
  const Real young = mu * (3 * lambda + 2 * mu) / (lambda + mu);
  const Real poisson = lambda / (2 * (lambda + mu));
  const Sym3<Real> s = rock.stress({1e-3, -poisson * 1e-3, -poisson * 1e-3, 0, 0, 0});
  CHECK(relative_error(s.xx, young * 1e-3) < 1e-15);
  CHECK(std::abs(s.yy) < 2e-9);
}

TEST_CASE("the stress turns with the strain") {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Sym3<Real> strain = symmetric(random.matrix(1e-3));
    const Mat r = random.rotation();
    const Sym3<Real> turned = symmetric(r * full(strain) * transpose(r));
    CHECK(distance(full(rock.stress(turned)), r * full(rock.stress(strain)) * transpose(r)) <
          3e-16 * 1e8);
  }
}

TEST_CASE("stresses of a lane are those of its numbers") {
  Random random(2);
  check_lanes<8, 6>(
      [](const auto* in, auto* out) {
        using T = std::remove_cvref_t<decltype(*in)>;
        const auto s =
            ElasticConstants<T>{in[6], in[7]}.stress({in[0], in[1], in[2], in[3], in[4], in[5]});
        out[0] = s.xx, out[1] = s.yy, out[2] = s.zz, out[3] = s.xy, out[4] = s.yz, out[5] = s.zx;
      },
      [&](Real* in) {
        for (int k = 0; k < 6; ++k) in[k] = random.between(-1e-3, 1e-3);
        in[6] = random.between(1e9, 2e10), in[7] = random.between(1e9, 2e10);
      });
}

}  // namespace cdem::test
