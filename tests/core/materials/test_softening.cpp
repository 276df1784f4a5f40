// Strengths that fall with slip: a table, what each strength falls with, a law that softens.
#include "core/materials/flow_by.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// A material with cohesion 4 that falls to 2 over 1 m and to 1 over 2 m more, from slip 0; T
/// from 3.
struct Softening {
  std::vector<Real> row = std::vector<Real>(material_row);
  Real lambda = 100, mu = 100;
  Index law;

  explicit Softening(Index number) : law(number) {
    for (Index k = 0; k < falling_numbers * fall_pieces; ++k)
      row[law_numbers + 1 + k * piece_numbers] = unlimited;
    row[0] = 4, row[3] = unlimited;
    row[law_numbers] = 1;
    piece(0, 0, 0, 1, -2), piece(0, 1, 1, 2, -0.5);
  }
  void piece(Index number, Index s, Real begin, Real length, Real slope) {
    Real* p = row.data() + law_numbers + 1 + (number * fall_pieces + s) * piece_numbers;
    p[0] = begin, p[1] = length, p[2] = slope;
  }
  MaterialTable table() const { return {&lambda, &mu, &law, row.data()}; }
};

struct Rows {
  Real state[4], h = 0.5;
  Real at(Index k) const { return state[k]; }
  Real size() const { return h; }
};

}  // namespace

TEST_CASE("a strength falls along its table, with strain times the size of the element") {
  const Softening rock(1);
  const Real known[][2] = {{0, 4}, {1, 3}, {2, 2}, {4, 1.5}, {6, 1}, {60, 1}};  // strain, cohesion
  for (const auto& [strain, cohesion] : known) {
    const auto law = law_of<MohrCoulomb>(rock.table(), 0, Rows{{strain, 9, 9, 9}});
    CHECK(law.cohesion == doctest::Approx(cohesion).epsilon(1e-15));
    CHECK(law.tensile_strength == unlimited);
  }
}

TEST_CASE("strengths fall with the flow that is theirs") {
  for (Index k = 0; k < falling_numbers; ++k)
    CHECK(falls_with(k) == std::array{0, 0, 0, 1, 2, 2, 2, 3}[k]);
}

TEST_CASE("only a material with tables softens") {
  Softening rock(1);
  rock.row[law_numbers] = 0;
  CHECK(law_of<MohrCoulomb>(rock.table(), 0, Rows{{9, 9, 9, 9}}).cohesion == 4);
}

TEST_CASE("sheared rock gives the work of its table per area") {
  // simple shear, phi 0: strain angle / sqrt(3), so the slip of the angle is sqrt(3) times that of
  // the table: work to the residual sqrt(3) (3 * 1 + 1.5 * 2)
  const Softening rock(1);
  Rows rows{{0, 0, 0, 0}};
  Real stress = 0, spent = 0;
  for (int step = 0; step < 200000; ++step) {
    const Real trial = stress + rock.mu * 1e-4;
    const auto now = flow(rock.table(), 0, 1.0, Sym3<Real>{0, 0, 0, trial, 0, 0}, rows);
    if (!now.any) {
      stress = trial;
      continue;
    }
    const Real angle = 2 * now.strain.xy;
    const Real left = trial - rock.mu * angle;
    if (rows.state[0] * rows.h < 3) spent += 0.5 * (stress + left) * angle * rows.h;
    stress = left;
    for (Index k = 0; k < 2; ++k) rows.state[k] = now.state[k];
  }
  CHECK(relative_error(spent, std::sqrt(3) * 6) < 1e-4);
  CHECK(relative_error(stress, 1) < 1e-12);
}

}  // namespace cdem::test
