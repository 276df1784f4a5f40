// Stress and strain energy of all elements of a model.
#include "core/elements/elements.hpp"
#include "core/elements/report.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A cube that is stretched by so much along z.
struct Stretched : Scene {
  explicit Stretched(Formulation formulation, Real strain = 1e-6) {
    model.formulation = formulation;
    add_box({0, 0, 0}, {1, 1, 1});
    build();
    state.dt = state.dt_last = 1e-4;
    for (Index i = 0; i < 8; ++i) {
      const Vec shift{0, 0, strain * position(i).z};
      put(motion(i), position(i) + shift);
      put(motion(i) + 4, Real(1 / state.dt_last) * shift);
    }
    update_element_forces(model, state, {}, {.everything_awake = true});
  }
  Real stress(Index row) const { return on_host(state.hex8.stress)[row * model.hex8.stride]; }
};

}  // namespace

TEST_CASE("the mean stress is that of the law, in every formulation") {
  for (const Formulation formulation : {Formulation::corotational, Formulation::incremental,
                                        Formulation::paper_incremental, Formulation::paper_total}) {
    Stretched cube(formulation);
    report_elements(cube.model, cube.state, {});
    const Rock rock = cube.rock;
    CHECK(relative_error(cube.stress(2), 1e-6 * (rock.lambda + 2 * rock.mu)) < 3e-6);
    CHECK(relative_error(cube.stress(0), 1e-6 * rock.lambda) < 3e-6);
    CHECK(std::abs(cube.stress(3)) < 1e-20);
    CHECK(relative_error(on_host(cube.state.hex8.energy)[0],
                         0.5e-12 * (rock.lambda + 2 * rock.mu)) < 3e-6);
  }
}

TEST_CASE("reported stress leaves the energies of the last sample alone") {
  Stretched cube(Formulation::corotational);
  on_host(cube.state.hex8.energy)[0] = 42;
  report_stress(cube.model, cube.state);
  CHECK(on_host(cube.state.hex8.energy)[0] == 42);
  CHECK(cube.stress(2) > 0);
}

}  // namespace cdem::test
