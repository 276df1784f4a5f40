// Element forces from the total deformation: no force of rigid motion, the derivative of an energy.
#include "core/base/parallel.hpp"
#include "core/elements/corotational.hpp"
#include "tests/core/elements/reference.hpp"

namespace cdem::test {

namespace {

#define ALL_SHAPES Tet4, Pyramid5, Wedge6, Hex8, Hex8OnePoint

/// Elements with the tables that the kernels write.
template <class Shape, class Rotation = FollowRotation>
struct Loaded : Elements<Shape> {
  using Elements<Shape>::Elements;
  std::vector<Real> stress = std::vector<Real>(6 * this->stride);
  std::vector<Real> energy = std::vector<Real>(this->stride);
  std::vector<Real> damping_work = std::vector<Real>(this->stride);
  std::vector<Real> corner_force = std::vector<Real>(4 * Shape::nodes * this->stride);
  Real damping_time = 0, dt = 1;

  CorotationalForce<Shape, Rotation> force_kernel() {
    return {this->columns(), damping_time, dt, {damping_work.data(), this->stride}, {}};
  }
  CorotationalReport<Shape, Rotation> report_kernel() {
    return {this->columns(), {stress.data(), this->stride}, {energy.data(), this->stride}, {}, {}};
  }
  void update() {
    this->run(force_kernel(), corner_force);
    for_each_lane({}, this->count, Blocks{}, report_kernel());
  }
  Vec force(Index e, Index k) const {
    return vector_at(corner_force.data() + 4 * (e * Shape::nodes + k));
  }
  Sym3<Real> stress_of(Index e) const {
    const auto s = [&](Index row) { return stress[row * this->stride + e]; };
    return {s(0), s(1), s(2), s(3), s(4), s(5)};
  }
  Real energy_of(Index e) {
    report_kernel()(One{e});
    return energy[e];
  }
  /// Deform all elements at random, up to about a strain, and turn each.
  void deform(Random& random, Real strain) {
    for (Index e = 0; e < this->count; ++e) {
      const Mat turn = random.rotation();
      const Vec shift = random.vector(3);
      for (Index k = 0; k < Shape::nodes; ++k) {
        this->place(e, k, turn * (this->rest(e, k) + random.vector(strain)) + shift);
        this->move(e, k, random.vector(1));
      }
    }
  }
};

/// Rock of about 1e10 Pa and elements of about 1 m: forces are compared with this  [N].
constexpr Real stiff = 1e10;

Real energy_density(const Rock& rock, const Sym3<Real>& strain) {
  return 0.5 * rock.lambda * trace(strain) * trace(strain) + rock.mu * contract(strain, strain);
}

/// The same of rocks that flow, some of them: materials 0 elastic, 1 Mohr-Coulomb.
template <class Shape>
struct Flowing : Loaded<Shape> {
  Flowing(Index count, Random& random) : Loaded<Shape>(count, random) {
    for (Index e = 0; e < count; e += 2) this->material[e] = 1;
  }
  static constexpr Real strength = 1e7;  // of rock of about 1e10 Pa
  const Real lambda[2] = {6e9, 6e9}, mu[2] = {4e9, 4e9};
  const Index law[2] = {0, 1};
  std::vector<Real> parameters = [] {
    std::vector<Real> rows(2 * material_row);
    const Real row[] = {strength, 0.6, 0.2, 0.5 * strength};
    std::copy(std::begin(row), std::end(row), rows.begin() + material_row);
    return rows;
  }();
  std::vector<Real> history = std::vector<Real>(point_history * Shape::points * this->stride);
  std::vector<Real> work = std::vector<Real>(this->stride);

  CorotationalForce<Shape, FollowRotation, PointFlow<Shape>> flow_kernel() {
    auto columns = this->columns();
    columns.materials = {lambda, mu, law, parameters.data()};
    return {columns, 0, this->dt, {this->damping_work.data(), this->stride}, flow()};
  }
  PointFlow<Shape> flow() {
    return {{history.data(), this->stride}, {work.data(), this->stride}, this->dt};
  }
  Real energy_of(Index e) {
    auto kernel = this->report_kernel();
    kernel.columns.materials = {lambda, mu, law, parameters.data()};
    kernel.flow = flow();
    kernel(One{e});
    return this->energy[e];
  }
};

}  // namespace

TEST_CASE_TEMPLATE("rigid motion gives no force, stress or energy", Shape, ALL_SHAPES) {
  Random random(1);
  Loaded<Shape> elements(3 * lanes, random);
  for (Index e = 0; e < elements.count; ++e) {
    const Mat turn = random.rotation();
    const Vec shift = random.vector(3);
    for (Index k = 0; k < Shape::nodes; ++k)
      elements.place(e, k, turn * elements.rest(e, k) + shift);
  }
  elements.update();
  Real worst = 0;
  for (Index e = 0; e < elements.count; ++e) {
    for (Index k = 0; k < Shape::nodes; ++k) worst = std::max(worst, norm(elements.force(e, k)));
    CHECK(elements.energy[e] < 1e-29 * stiff);
  }
  CHECK(worst < 5e-15 * stiff);
}

TEST_CASE_TEMPLATE("forces of an element sum to no force and no moment", Shape, ALL_SHAPES) {
  Random random(2);
  Loaded<Shape> elements(3 * lanes, random);
  elements.deform(random, 0.01);
  elements.update();
  Real worst_f = 0, worst_m = 0;
  for (Index e = 0; e < elements.count; ++e) {
    Vec sum{0, 0, 0}, moment{0, 0, 0};
    for (Index k = 0; k < Shape::nodes; ++k) {
      sum = sum + elements.force(e, k);
      moment = moment + cross(elements.position(e, k), elements.force(e, k));
    }
    worst_f = std::max(worst_f, norm(sum));
    worst_m = std::max(worst_m, norm(moment));
  }
  CHECK(worst_f < 3e-17 * stiff);
  CHECK(worst_m < 1e-16 * stiff);
}

TEST_CASE_TEMPLATE("the force is minus the derivative of the energy", Shape, ALL_SHAPES) {
  Random random(3);
  Loaded<Shape> elements(4, random);
  elements.deform(random, 0.02);
  elements.update();
  Real worst = 0;
  for (Index e = 0; e < elements.count; ++e)
    for (Index k = 0; k < Shape::nodes; ++k) {
      const Vec way = random.direction(), x = elements.position(e, k);
      constexpr Real step = 1e-5;
      elements.place(e, k, x + step * way);
      const Real ahead = elements.energy_of(e);
      elements.place(e, k, x - step * way);
      const Real behind = elements.energy_of(e);
      elements.place(e, k, x);
      worst =
          std::max(worst, std::abs(dot(elements.force(e, k), way) + (ahead - behind) / (2 * step)));
    }
  CHECK(worst < 6e-11 * stiff);
}

TEST_CASE_TEMPLATE("a uniform stretch stores the energy of its strain, and turns the stress", Shape,
                   ALL_SHAPES) {
  Random random(4);
  const Rock rock;
  Loaded<Shape> elements(lanes + 1, random, 0.15, rock);
  const Mat turn = random.rotation(), stretch = random.stretch(0.01);
  for (Index e = 0; e < elements.count; ++e)
    for (Index k = 0; k < Shape::nodes; ++k)
      elements.place(e, k, turn * (stretch * elements.rest(e, k)));
  elements.update();
  const Sym3<Real> strain = symmetric(stretch - identity<Real>());
  const Mat stress =
      turn * (rock.lambda * trace(strain) * identity<Real>() + Real(2 * rock.mu) * full(strain)) *
      transpose(turn);
  for (Index e = 0; e < elements.count; ++e) {
    const Real energy = elements.geometry[e].whole() * energy_density(rock, strain);
    CHECK(relative_error(elements.energy[e], energy) < 3e-13);
    CHECK(distance(full(elements.stress_of(e)), stress) < 4e-15 * stiff);
  }
}

TEST_CASE("elements that may flow find their rotation at large strain too") {
  Random random(8);
  Flowing<Tet4> elements(lanes, random);
  const Mat turn = random.rotation(), stretch = {{1.4, 0, 0}, {0, 0.7, 0}, {0, 0, 1}};
  for (Index e = 0; e < elements.count; ++e)
    for (Index k = 0; k < 4; ++k) elements.place(e, k, turn * (stretch * elements.rest(e, k)));
  const Sym3<Real> strain = symmetric(stretch - identity<Real>());
  const Rock rock{elements.lambda[0], elements.mu[0]};
  for (Index e = 0; e < elements.count; ++e) {
    const Real energy = elements.geometry[e].whole() * energy_density(rock, strain);
    CHECK(relative_error(elements.energy_of(e), energy) < 1e-8);  // 3e-6 after three steps
  }
}

TEST_CASE_TEMPLATE("one by one and in lanes the bits are the same", Shape, ALL_SHAPES) {
  Random random(5);
  Loaded<Shape> elements(2 * lanes + 1, random);
  elements.deform(random, 0.02);
  elements.damping_time = 1e-3;
  elements.update();
  const auto force = elements.corner_force, energy = elements.energy, stress = elements.stress,
             work = elements.damping_work;
  std::fill(elements.damping_work.begin(), elements.damping_work.end(), 0);
  for (Index e = 0; e < elements.count; ++e) {
    elements.force_kernel().forces(One{e}).store({elements.corner_force.data()}, One{e});
    elements.report_kernel()(One{e});
  }
  CHECK(elements.corner_force == force);
  CHECK(elements.energy == energy);
  CHECK(elements.stress == stress);
  CHECK(elements.damping_work == work);
}

TEST_CASE_TEMPLATE("the dashpot takes out the work of its force", Shape, ALL_SHAPES) {
  Random random(6);
  Loaded<Shape> elements(lanes, random);
  elements.deform(random, 0);  // turned only
  elements.dt = 0.1;
  elements.update();
  const auto elastic = elements.corner_force;
  elements.damping_time = 1e-3;
  elements.update();
  for (Index e = 0; e < elements.count; ++e) {
    Real work = 0;
    for (Index k = 0; k < Shape::nodes; ++k) {
      const Vec of_dashpot =
          elements.force(e, k) - vector_at(elastic.data() + 4 * (e * Shape::nodes + k));
      work -= elements.dt * dot(of_dashpot, elements.velocity(e, k));
    }
    CHECK(elements.damping_work[e] > 0);
    CHECK(relative_error(elements.damping_work[e], work) < 3e-15);
  }
}

TEST_CASE_TEMPLATE("the dashpot does not brake a rigid motion", Shape, ALL_SHAPES) {
  Random random(7);
  Loaded<Shape> elements(lanes, random);
  elements.damping_time = 1e-3;
  elements.deform(random, 0);
  for (Index e = 0; e < elements.count; ++e) {
    const Vec spin = random.vector(1), drift = random.vector(1);
    for (Index k = 0; k < Shape::nodes; ++k)
      elements.move(e, k, drift + cross(spin, elements.position(e, k)));
  }
  elements.update();
  Real worst = 0;
  for (Index e = 0; e < elements.count; ++e) {
    for (Index k = 0; k < Shape::nodes; ++k) worst = std::max(worst, norm(elements.force(e, k)));
    CHECK(std::abs(elements.damping_work[e]) < 1e-32 * stiff);
  }
  CHECK(worst < 6e-15 * stiff);
}

TEST_CASE_TEMPLATE("the dashpot feels the spin of a strained body by strain squared", Shape,
                   ALL_SHAPES) {
  Random random(10);
  constexpr Real strain = 1e-3, spin_size = 1;
  Loaded<Shape> elements(lanes, random);
  for (Index e = 0; e < elements.count; ++e) {
    const Mat turn = random.rotation() * random.stretch(strain);
    const Vec spin = spin_size * random.direction();
    for (Index k = 0; k < Shape::nodes; ++k) {
      elements.place(e, k, turn * elements.rest(e, k));
      elements.move(e, k, cross(spin, elements.position(e, k)));
    }
  }
  elements.update();
  const auto elastic = elements.corner_force;
  elements.damping_time = 1;
  elements.update();
  Real worst = 0;
  for (std::size_t k = 0; k < elastic.size(); ++k)
    worst = std::max(worst, std::abs(elements.corner_force[k] - elastic[k]));
  CHECK(worst < 5 * strain * strain * spin_size * stiff);
}

TEST_CASE_TEMPLATE("flow one by one and in lanes: the same bits, also of elastic rock between",
                   Shape, ALL_SHAPES) {
  Random random(11);
  Flowing<Shape> elements(8 + 2 * lanes + 1, random);
  elements.deform(random, 0.01);
  const auto rest = elements.history;
  elements.run(elements.flow_kernel(), elements.corner_force);
  const auto force = elements.corner_force, history = elements.history, work = elements.work;
  elements.history = rest;
  std::fill(elements.work.begin(), elements.work.end(), 0);
  int flowed = 0;
  for (Index e = 0; e < elements.count; ++e) {
    elements.flow_kernel().forces(One{e}).store({elements.corner_force.data()}, One{e});
    for (const Index row : {6, 7}) flowed += elements.history[row * elements.stride + e] > 0;
    CHECK(elements.work[e] >= 0);  // also where a step strains by far too much
    if (elements.material[e] == 0) CHECK(elements.work[e] == 0);
  }
  CHECK(flowed > lanes);
  CHECK(elements.corner_force == force);
  CHECK(elements.history == history);
  CHECK(elements.work == work);
}

TEST_CASE_TEMPLATE("forces of an element that flowed sum to no force and no moment", Shape,
                   ALL_SHAPES) {
  Random random(13);
  Flowing<Shape> elements(3 * lanes, random);
  Real worst_f = 0, worst_m = 0;
  for (int k = 0; k < 3; ++k) {  // so that stress and strain have other axes
    elements.deform(random, 0.02);
    elements.run(elements.flow_kernel(), elements.corner_force);
  }
  for (Index e = 0; e < elements.count; ++e) {
    Vec sum{0, 0, 0}, moment{0, 0, 0};
    for (Index k = 0; k < Shape::nodes; ++k) {
      sum = sum + elements.force(e, k);
      moment = moment + cross(elements.position(e, k), elements.force(e, k));
    }
    worst_f = std::max(worst_f, norm(sum));
    worst_m = std::max(worst_m, norm(moment));
  }
  CHECK(worst_f < 1e-16 * stiff);
  CHECK(worst_m < 1e-14 * stiff);
}

TEST_CASE_TEMPLATE("what the mean force of each step supplies is stored or plastic work", Shape,
                   ALL_SHAPES) {
  // what central differences make of the work; the error falls with the square of the step
  const auto error_of = [](Index steps) {
    Random random(12);
    Flowing<Shape> elements(1, random);
    elements.dt = 1.0 / steps;
    std::vector<Vec> way;
    const Mat stretch{{0.01, 0.01, 0}, {0, 0, 0.01}, {0.01, 0, 0}};
    for (Index k = 0; k < Shape::nodes; ++k)
      way.push_back(stretch * elements.rest(0, k) + random.vector(0.003));
    Real supplied = 0, force_before = 0;
    for (Index step = 1; step <= steps; ++step) {
      for (Index k = 0; k < Shape::nodes; ++k) {
        elements.place(0, k, elements.rest(0, k) + elements.dt * step * way[k]);
        elements.move(0, k, way[k]);
      }
      elements.flow_kernel().forces(One{0}).store({elements.corner_force.data()}, One{0});
      Real force = 0;
      for (Index k = 0; k < Shape::nodes; ++k) force -= dot(elements.force(0, k), way[k]);
      supplied += 0.5 * elements.dt * (force_before + force);
      force_before = force;
    }
    const Real stored = elements.energy_of(0);
    CHECK(elements.work[0] > 0.1 * stored);
    return (stored + elements.work[0] - supplied) / supplied;
  };
  CHECK(std::abs(error_of(40)) < 1e-5);
  CHECK(relative_error(error_of(20), 4 * error_of(40)) < 0.1);
}

TEST_CASE("bending of a hexahedron of eight points does not lock in incompressible rock") {
  // the volumetric strain of bending, curvature * z, is zero in the mean
  const auto energy = [](Real lambda) {
    Random random(8);
    Loaded<Hex8> cube(1, random, 0, Rock{lambda, 4e9});
    for (Index k = 0; k < 8; ++k) {
      const Vec x = cube.rest(0, k);
      cube.place(0, k, x + Vec{1e-6 * x.x * x.z, 0, 0});
    }
    return cube.energy_of(0);
  };
  CHECK(relative_error(energy(4e12), energy(4e9)) < 5e-11);
}

TEST_CASE_TEMPLATE("without rotation the force is linear in the displacement, Eq. 1", Shape,
                   ALL_SHAPES) {
  Random random(9);
  Loaded<Shape, IgnoreRotation> elements(lanes, random);
  std::vector<Vec> shift;
  for (Index e = 0; e < elements.count; ++e)
    for (Index k = 0; k < Shape::nodes; ++k) shift.push_back(random.vector(0.01));
  std::vector<Real> force[2];
  for (const Index times : {1, 2}) {
    for (Index e = 0; e < elements.count; ++e)
      for (Index k = 0; k < Shape::nodes; ++k)
        elements.place(e, k, elements.rest(e, k) + Real(times) * shift[e * Shape::nodes + k]);
    elements.update();
    force[times - 1] = elements.corner_force;
  }
  for (std::size_t i = 0; i < force[0].size(); ++i)
    CHECK(std::abs(force[1][i] - 2 * force[0][i]) < 1e-14 * stiff);
}

}  // namespace cdem::test
