// Tets with the mean dilatation of their nodes: a force of an energy, softer than tets of their
// own.
#include <vector>

#include "core/elements/elements.hpp"
#include "core/elements/nodal_mean.hpp"
#include "core/elements/report.hpp"
#include "core/materials/laws.hpp"
#include "core/model/tiles.hpp"
#include "tests/core/elements/reference.hpp"

namespace cdem::test {

namespace {

/// A block of n^3 cells of six tets each, of rock that flows, its nodes shifted at random.
struct Mesh {
  Model model;
  State state;
  std::vector<Vec> rest;
  Real lambda = 6e9, mu = 4e9;  // [Pa]
  static constexpr Real stiff = 1e10, strength = 1e7;

  explicit Mesh(bool averages, Index n = 2, Real distortion = 0.1) {
    Random random(1);
    for (Index z = 0; z <= n; ++z)
      for (Index y = 0; y <= n; ++y)
        for (Index x = 0; x <= n; ++x)
          rest.push_back(Vec{Real(x), Real(y), Real(z)} + random.vector(distortion));
    list_tets(n);
    build(averages);
  }
  void set_rock(Real new_lambda, Real cohesion) {
    lambda = new_lambda;
    on_host(model.material_lambda)[0] = lambda;
    on_host(model.material_parameters)[0] = cohesion;
    on_host(model.material_parameters)[3] = cohesion;  // tensile strength
  }
  void place(Index node, const Vec& x) { put(state.nodes.motion.data() + 8 * node, x); }
  void move(Index node, const Vec& v) { put(state.nodes.motion.data() + 8 * node + 4, v); }
  Vec position(Index node) const { return vector_at(state.nodes.motion.data() + 8 * node); }
  Index nodes() const { return model.node_count; }
  void deform(Random& random, Real strain) {
    for (Index i = 0; i < nodes(); ++i) place(i, rest[i] + random.vector(strain));
  }
  void step() {
    update_nodal_means(model, state, {});
    update_element_forces(model, state, {}, {.everything_awake = true});
  }
  Vec force(Index node) const {
    Vec sum{0, 0, 0};
    for (Index t = on_host(state.nodes.tile_first)[node];
         t < on_host(state.nodes.tile_first)[node + 1]; ++t)
      sum = sum + vector_at(state.tile_force.data() + 4 * t);
    return sum;
  }
  Real energy() {
    report_elements(model, state, {});
    Real sum = 0;
    for (Index e = 0; e < model.tet4.count; ++e) sum += on_host(state.tet4.energy)[e];
    return sum;
  }
  Real plastic_work() const {
    Real sum = 0;
    for (Index e = 0; e < model.tet4.count; ++e) sum += on_host(state.tet4.plastic_work)[e];
    return sum;
  }
  /// Inelastic strains whose stress grows along z, as an initial stress has them.
  void press_at_the_start() {
    for (Index e = 0; e < model.tet4.stride; ++e)
      for (const Index row : {0, 1, 2}) {
        const Index tet = std::min(e, model.tet4.count - 1);
        Real z = 0;
        for (Index k = 0; k < 4; ++k) z += 0.25 * rest[tets[4 * tet + k]].z;
        on_host(state.tet4.history)[row * model.tet4.stride + e] = row == 2 ? 1e-4 * z : 0.5e-4 * z;
      }
  }
  std::vector<Index> tets;  // [tet][4]

 private:
  void list_tets(Index n) {
    const Index way[6][2] = {{0, 1}, {1, 0}, {1, 2}, {2, 1}, {2, 0}, {0, 2}};
    const Index side[3] = {1, n + 1, (n + 1) * (n + 1)};
    for (Index z = 0; z < n; ++z)
      for (Index y = 0; y < n; ++y)
        for (Index x = 0; x < n; ++x)
          for (Index t = 0; t < 6; ++t) {
            const Index first = x + y * side[1] + z * side[2], a = first + side[way[t][0]];
            const Index b = a + side[way[t][1]], last = first + side[0] + side[1] + side[2];
            const bool turned = t % 2 == 1;
            tets.insert(tets.end(), {first, turned ? b : a, turned ? a : b, last});
          }
  }
  void build(bool averages) {
    ElementSet& e = model.tet4;
    e.count = Index(tets.size() / 4), e.stride = padded_stride(e.count);
    e.corners = 4, e.points = 1;
    model.node_count = Index(rest.size());
    e.nodes.resize(4 * std::size_t(e.stride));
    e.gradient.resize(9 * std::size_t(e.stride));
    e.material.resize(e.stride);
    e.volume.resize(e.stride);
    if (averages) e.nodal_mean.resize(e.stride, 1);
    for (Index i = 0; i < e.stride; ++i) build_tet(i, std::min(i, e.count - 1));
    model.material_lambda.resize(1, lambda);
    model.material_mu.resize(1, mu);
    model.material_law.resize(1, 1);  // mohr-coulomb
    model.material_parameters.resize(material_row);
    const Real row[] = {strength, 0.6, 0.2, 0.5 * strength};
    std::copy(std::begin(row), std::end(row), model.material_parameters.data());
    build_state();
  }
  void build_tet(Index place_in_table, Index tet) {
    ElementSet& e = model.tet4;
    Vec x[4];
    for (Index k = 0; k < 4; ++k) {
      x[k] = rest[tets[4 * tet + k]];
      on_host(e.nodes)[k * e.stride + place_in_table] = tets[4 * tet + k];
    }
    const ElementGeometry<Tet4> g(x, 1);
    CHECK(g.volume[0] > 0);
    on_host(e.volume)[place_in_table] = g.volume[0];
    for (Index k = 1; k < 4; ++k)
      for (Index axis = 0; axis < 3; ++axis)
        on_host(e.gradient)[((k - 1) * 3 + axis) * e.stride + place_in_table] =
            axis == 0   ? g.gradient[0][k].x
            : axis == 1 ? g.gradient[0][k].y
                        : g.gradient[0][k].z;
  }
  void build_state() {
    const ElementSet& e = model.tet4;
    ElementState& es = state.tet4;
    es.stress.resize(6 * std::size_t(e.stride));
    es.history.resize(std::size_t(point_history) * e.stride);
    for (Column<Real>* column : {&es.energy, &es.damping_work, &es.plastic_work, &es.yielded})
      column->resize(e.stride);
    state.nodes.motion.resize(8 * rest.size());
    state.dt = state.dt_last = 1;
    for (Index i = 0; i < nodes(); ++i) place(i, rest[i]);
    list_tiles(model, state);
    list_nodal_means(model, state);
  }
};

/// Largest difference of the forces of two meshes  [N].
Real differ(const Mesh& a, const Mesh& b) {
  Real worst = 0;
  for (Index i = 0; i < a.nodes(); ++i) worst = std::max(worst, distance(a.force(i), b.force(i)));
  return worst;
}

}  // namespace

TEST_CASE("the force of averaged tets is minus the derivative of their energy") {
  Random random(2);
  Mesh mesh(true);
  mesh.press_at_the_start();
  mesh.step();
  for (int k = 0; k < 2; ++k) {  // some flow
    mesh.deform(random, 0.02);
    mesh.step();
  }
  CHECK(mesh.plastic_work() != 0);
  mesh.set_rock(mesh.lambda, 1e12);  // nothing flows any more
  mesh.deform(random, 0.02);
  mesh.step();
  Real worst = 0;
  for (Index i = 0; i < mesh.nodes(); ++i) {
    const Vec way = random.direction(), x = mesh.position(i);
    constexpr Real step = 1e-5;
    mesh.place(i, x + step * way);
    const Real ahead = mesh.energy();
    mesh.place(i, x - step * way);
    const Real behind = mesh.energy();
    mesh.place(i, x);
    worst = std::max(worst, std::abs(dot(mesh.force(i), way) + (ahead - behind) / (2 * step)));
  }
  CHECK(worst < 5e-11 * Mesh::stiff);
}

TEST_CASE("averaged tets: no net force or moment, and both turn with the frame") {
  Random random(3);
  Mesh mesh(true), turned(true);
  const Mat turn = random.rotation();
  const Vec shift = random.vector(3);
  for (int k = 0; k < 3; ++k) {
    mesh.deform(random, 0.02);
    for (Index i = 0; i < mesh.nodes(); ++i) turned.place(i, turn * mesh.position(i) + shift);
    mesh.step();
    turned.step();
  }
  Vec sum{0, 0, 0}, moment{0, 0, 0};
  Real worst = 0;
  for (Index i = 0; i < mesh.nodes(); ++i) {
    sum = sum + mesh.force(i);
    moment = moment + cross(mesh.position(i), mesh.force(i));
    worst = std::max(worst, distance(turned.force(i), turn * mesh.force(i)));
  }
  CHECK(mesh.plastic_work() != 0);
  CHECK(norm(sum) < 1e-15 * Mesh::stiff);
  CHECK(norm(moment) < 1e-14 * Mesh::stiff);
  CHECK(worst < 1e-12 * Mesh::stiff);
}

TEST_CASE("a uniform strain gives averaged tets the forces of tets of their own") {
  Random random(4);
  Mesh averaged(true), full(false);
  const Mat stretch = random.rotation() * random.stretch(1e-4);
  for (Mesh* mesh : {&averaged, &full}) {
    for (Index i = 0; i < mesh->nodes(); ++i) mesh->place(i, stretch * mesh->rest[i]);
    mesh->step();
  }
  CHECK(differ(averaged, full) < 1e-14 * Mesh::stiff);
}

TEST_CASE("initial stress acts as it is, to the bit") {
  Mesh averaged(true), full(false);
  for (Mesh* mesh : {&averaged, &full}) {
    mesh->press_at_the_start();
    mesh->step();
    mesh->step();
  }
  CHECK(norm(full.force(0)) > 1e-6 * Mesh::stiff);
  CHECK(differ(averaged, full) == 0);
}

TEST_CASE("averaged tets are never stiffer, and do not lock when they bend or keep their volume") {
  Random random(5);
  for (int k = 0; k < 20; ++k) {
    Mesh averaged(true), full(false);
    averaged.set_rock(1e12, 1e15);
    full.set_rock(1e12, 1e15);
    averaged.step();
    averaged.deform(random, 1e-6);
    for (Index i = 0; i < full.nodes(); ++i) full.place(i, averaged.position(i));
    averaged.step();
    CHECK(averaged.energy() < full.energy());
  }
  // the exact motion keeps the volume everywhere: what resists are the dilatations of the mesh
  const auto bending = [](bool averages) {
    Mesh mesh(averages, 4, 0);
    mesh.set_rock(6e12, 1e15);
    mesh.step();
    for (Index i = 0; i < mesh.nodes(); ++i) {
      const Vec x = mesh.rest[i];
      mesh.place(i, x + Real(1e-6) * Vec{x.x * x.z, 0, -0.5 * (x.x * x.x + x.z * x.z)});
    }
    return mesh.energy();
  };
  CHECK(bending(true) < 0.2 * bending(false));
}

TEST_CASE("averaged tets: what the mean force of each step supplies is stored or plastic work") {
  const auto error_of = [](Index steps) {
    Random random(6);
    Mesh mesh(true);
    mesh.press_at_the_start();
    mesh.state.dt = mesh.state.dt_last = 1.0 / steps;
    std::vector<Vec> way;
    const Mat stretch{{0.01, 0.01, 0}, {0, 0, 0.01}, {0.01, 0, 0}};
    for (const Vec& x : mesh.rest) way.push_back(stretch * x + random.vector(0.003));
    const auto power = [&] {
      Real sum = 0;
      for (Index i = 0; i < mesh.nodes(); ++i) sum -= dot(mesh.force(i), way[i]);
      return sum;
    };
    mesh.step();
    const Real start = mesh.energy();
    Real supplied = 0, before = power();
    for (Index step = 1; step <= steps; ++step) {
      for (Index i = 0; i < mesh.nodes(); ++i) {
        mesh.place(i, mesh.rest[i] + mesh.state.dt * step * way[i]);
        mesh.move(i, way[i]);
      }
      mesh.step();
      const Real now = power();
      supplied += 0.5 * mesh.state.dt * (before + now);
      before = now;
    }
    const Real stored = mesh.energy() - start;
    CHECK(mesh.plastic_work() > 0.1 * stored);
    return (stored + mesh.plastic_work() - supplied) / supplied;
  };
  CHECK(std::abs(error_of(40)) < 1e-5);
  CHECK(relative_error(error_of(20), 4 * error_of(40)) < 0.1);
}

TEST_CASE("tets between averaged ones that are not keep their own dilatation") {
  Random random(7);
  Mesh some(true), full(false);
  for (Index e = 0; e < some.model.tet4.stride; ++e) on_host(some.model.tet4.nodal_mean)[e] = 0;
  on_host(some.model.tet4.nodal_mean)[3] = 1;  // alone: the mean is its own
  list_nodal_means(some.model, some.state);
  for (int k = 0; k < 3; ++k) {
    some.deform(random, 0.02);
    for (Index i = 0; i < full.nodes(); ++i) full.place(i, some.position(i));
    some.step();
    full.step();
  }
  Real worst = 0;
  for (Index i = 0; i < full.nodes(); ++i)
    if (std::count(some.tets.begin() + 12, some.tets.begin() + 16, i) == 0)
      worst = std::max(worst, distance(some.force(i), full.force(i)));
  CHECK(full.plastic_work() > 0);
  CHECK(worst < 1e-13 * Mesh::stiff);
}

}  // namespace cdem::test
