// Changes of the damping of rock between two runs: stresses stay, energies are booked.
#include "core/diagnostics/energy.hpp"
#include "core/elements/change_damping.hpp"
#include "core/elements/report.hpp"
#include "core/materials/laws.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

constexpr MaxwellBranches some{.weight = {0.2, 0.3, 0.4}, .rate = {1, 10, 100}};

/// Two boxes that ring.
struct Ringing : Scene {
  explicit Ringing(const MaxwellBranches& branches) {
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({3, 0, 0}, {1, 1, 1});
    bonded = true;
    build();
    model.initial_stress = true;
    state.hex8.history.resize(std::size_t(point_history * model.hex8.points) * model.hex8.stride);
    change_damping(model, state, branches, 0);
    start();
    Random random(1);
    for (Index i = 0; i < model.node_count; ++i) put(motion(i) + 4, random.vector(1e-3));
  }
  std::vector<Real> stress() {
    report_stress(model, state);
    return fetch(state.hex8.stress);
  }
  Real error() { return energies(model, state).error; }
};

}  // namespace

TEST_CASE("rock that gets other moduli keeps its stress, and the ledger goes on") {
  for (const MaxwellBranches& branches : {MaxwellBranches{}, some}) {
    Ringing rock(branches);
    rock.step(50);
    const auto before = rock.stress();
    const Real strain = energies(rock.model, rock.state).terms[energy_term("strain")];
    const Real mu = on_host(rock.model.material_mu)[0];
    change_moduli(rock.model, rock.state, 0.5);
    CHECK(moduli_part(rock.state) == 0.5);
    CHECK(on_host(rock.model.material_mu)[0] == 0.5 * mu);
    const auto after = rock.stress();
    // branches follow the strain of the coming step with other moduli
    const Real most = branches.any() ? 30 : 1e-9;
    for (std::size_t k = 0; k < before.size(); ++k) CHECK(std::abs(after[k] - before[k]) < most);
    CHECK(energies(rock.model, rock.state).terms[energy_term("strain")] > 1.5 * strain);
    rock.step(200);
    CHECK(std::abs(rock.error()) < 1e-6);
  }
}

TEST_CASE("what branches store when they end is lost") {
  Ringing rock(some);
  rock.step(50);
  const Energies before = energies(rock.model, rock.state);
  change_damping(rock.model, rock.state, {}, 0);
  const Energies after = energies(rock.model, rock.state);
  constexpr std::size_t strain = energy_term("strain"), damping = energy_term("damping");
  const Real stored = before.terms[strain] - after.terms[strain];
  CHECK(stored > 0);
  CHECK(relative_error(after.terms[damping] - before.terms[damping], stored) < 1e-11);
  CHECK(rock.state.hex8.branch.size() == 0);
  CHECK(!damps_rock(rock.model));
}

TEST_CASE("a stage with the same branches goes on with their stresses") {
  Ringing rock(some);
  rock.step(20);
  const auto branch = fetch(rock.state.hex8.branch);
  const Real stopped = rock.state.stopped_energy;
  change_damping(rock.model, rock.state, some, 0);
  CHECK(fetch(rock.state.hex8.branch) == branch);
  CHECK(rock.state.stopped_energy == stopped);
}

}  // namespace cdem::test
