// Columns of ground beside sides.
#include <vector>

#include "core/columns/advance.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// One column of a few layers, shaken at its foot or thrown.
struct OneColumn {
  static constexpr Index levels = 4;
  std::vector<Index> first{0, levels}, input_first{0, 1}, curve{0}, made{-1};
  std::vector<Real> layers, mass{1, 2, 2, 1}, foot{3, 3, 5, 0}, input{0, 0, 0, 0};
  std::vector<Real> value{1}, displacement = std::vector<Real>(4 * levels), before = displacement,
                              after = displacement;
  std::vector<Flag> acts{1}, bond = std::vector<Flag>(levels);
  std::vector<Real> branch;
  Real rock_time = 0, bond_time = 0;
  MaxwellBranches maxwell;
  Real damping = 0, dt = 0.1;
  Index step = 0;

  OneColumn() {
    for (Index l = 0; l < levels; ++l) layers.insert(layers.end(), {2, 12, 4, 6});
  }
  Layers ground() {
    return {.rows = layers.data(),
            .bond = bond.data(),
            .rock_time = rock_time,
            .bond_time = bond_time,
            .maxwell = {maxwell, dt},
            .motion = {displacement.data(), before.data(), after.data(),
                       branch.empty() ? nullptr : branch.data()}};
  }
  void advance() {
    AdvanceColumns{.level_first = first.data(),
                   .layers = ground(),
                   .mass = mass.data(),
                   .foot = foot.data(),
                   .input_first = input_first.data(),
                   .input_curve = curve.data(),
                   .input = input.data(),
                   .curve_value = value.data(),
                   .curve_velocity = value.data(),
                   .acts = acts.data(),
                   .mass_damping = damping,
                   .dt_before = dt,
                   .dt = dt,
                   .step = step,
                   .made = made.data()}(One{0});
  }
  void go(Index steps) {
    for (Index k = 0; k < steps; ++k, ++step) advance();
  }
  Vec at(const std::vector<Real>& rows, Index level) const {
    return vector_at(rows.data() + 4 * level);
  }
  Vec momentum() const {
    Vec all{0, 0, 0};
    for (Index l = 0; l < levels; ++l) all = all + mass[l] * at(after, l);
    return all;
  }
};

}  // namespace

TEST_CASE("stress on a horizontal plane follows from the slope of the displacement") {
  OneColumn c;
  const Real up[] = {0, 1, 2, 0, 4, 2, 1, 0};
  std::copy(std::begin(up), std::end(up), c.displacement.begin());
  const Vec stress = c.ground().stress_across(0);
  CHECK(stress.x == doctest::Approx(12));
  CHECK(stress.y == doctest::Approx(3));
  CHECK(stress.z == doctest::Approx(-6));
}

TEST_CASE("a column without dashpots keeps its momentum") {
  OneColumn c;
  c.foot = {0, 0, 0, 0};
  Random random(1);
  for (Real& v : c.before) v = random.between(-1, 1);
  Vec thrown{0, 0, 0};
  for (Index l = 0; l < c.levels; ++l) thrown = thrown + c.mass[l] * c.at(c.before, l);
  c.go(50);
  CHECK(norm(c.momentum() - thrown) < 1e-13);
}

TEST_CASE("a column that is pulled at its foot moves off with force over impedance") {
  OneColumn c;
  c.input = {6, 0, 10, 0};
  c.go(40000);
  for (Index l = 0; l < c.levels; ++l) {
    CHECK(c.at(c.after, l).x == doctest::Approx(2).epsilon(1e-9));  // 6 / 3
    CHECK(c.at(c.after, l).y == 0);
    CHECK(c.at(c.after, l).z == doctest::Approx(2).epsilon(1e-9));  // 10 / 5
  }
}

TEST_CASE("a driven foot has the velocity of its input") {
  OneColumn c;
  c.foot = {0, 0, 0, 1};
  c.input = {0.5, -1, 2, 0};
  c.go(3);
  CHECK(norm(c.at(c.after, 0) - Vec{0.5, -1, 2}) == 0);
}

TEST_CASE("a second call in a step changes nothing") {
  OneColumn one, two;
  for (OneColumn* c : {&one, &two}) c->input = {6, 1, 10, 0};
  for (Index k = 0; k < 20; ++k) {
    one.go(1);
    two.advance();
    two.go(1);
  }
  CHECK(one.displacement == two.displacement);
  CHECK(one.after == two.after);
}

TEST_CASE("a column that does not act has no velocity and stays where it is") {
  OneColumn c;
  c.input = {6, 1, 10, 0};
  c.go(10);
  c.acts[0] = 0;
  c.go(1);  // takes the last step over
  const std::vector<Real> there = c.displacement;
  c.go(5);
  CHECK(c.displacement == there);
  CHECK(norm(c.at(c.after, 2)) == 0);
}

TEST_CASE(
    "a dashpot adds its time times the rate of the strain, in rock and in bonds by their own") {
  OneColumn c;
  c.rock_time = 0.5;
  c.bond_time = 0.25;
  c.bond[1] = 1;
  for (Index l = 0; l < c.levels; ++l) c.before[4 * l] = l;
  CHECK(c.ground().stress_across(0).x == doctest::Approx(0.5 * 6 / 2));
  CHECK(c.ground().stress_across(1).x == doctest::Approx(0.25 * 6 / 2));
}

TEST_CASE("branches stiffen rock at once, and relax at their rates") {
  OneColumn c;
  c.maxwell = {.weight = {0.2, 0.3, 0.4}, .rate = {1, 5, 20}};
  c.branch.assign(std::size_t(4) * BranchStep::count * c.levels, 0.0);
  c.bond[1] = 1;
  c.foot = {0, 0, 0, 1};
  for (Index l = 1; l < c.levels; ++l) c.mass[l] = 1e30;
  // the foot moves alone, from the others away, at 1 m/s for one step, and then rests
  c.input = {-1, 0, 0, 0};
  c.go(1);
  c.input = {0, 0, 0, 0};
  c.go(1);
  Real stress = 0.1;  // [m] over the height, times 6 / 2
  for (Index j = 0; j < 3; ++j) {
    const Real passed = c.maxwell.rate[j] * c.dt;
    stress += c.maxwell.weight[j] * 0.1 * (1 - std::exp(-passed)) / passed;
  }
  CHECK(c.ground().stress_across(0).x == doctest::Approx(3 * stress).epsilon(1e-12));
  CHECK(norm(c.ground().stress_across(1)) < 1e-20);
  c.go(400);
  CHECK(c.ground().stress_across(0).x == doctest::Approx(3 * 0.1).epsilon(1e-9));
}

TEST_CASE("damping of the mass slows a column at its rate") {
  OneColumn c;
  c.foot = {0, 0, 0, 0};
  c.damping = 0.01;
  for (Index l = 0; l < c.levels; ++l) c.before[4 * l] = 1;
  c.go(100);
  CHECK(c.at(c.after, 1).x == doctest::Approx(std::pow(1 - 0.01 * c.dt, 100)).epsilon(1e-9));
}

}  // namespace cdem::test
