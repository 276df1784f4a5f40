// Blocks that come in: they act from then on, without stress where they lie.
#include "core/run/bring_in.hpp"
#include "core/run/take_out.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A box bonded to a fixed one below; what may be bonded above it comes later.
struct Later : Scene {
  Index middle, high;
  std::vector<Flag> flags;
  Later() {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1}, true);
    middle = add_box({0, 0, 1}, {1, 1, 1});
    high = add_box({0, 0, 2}, {1, 1, 1});
    model.loose_pairs = true;
    build();
    model.gravity = {0, 0, -10};
    model.damping.local = 0.8;
    set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}, {"friction_angle", 0.5}});
    start();
    flags.resize(model.node_count);
    for (Index i = 0; i < node_count(high); ++i) flags[first_node(high) + i] = 1;
    keep(model.hex8.material, material), keep(model.support, support);
    keep(model.mass_row_first, mass_row), keep(model.gravity_mass, gravity_mass);
    take_out(model, state, flags.data());
  }
  std::vector<Index> material, support, mass_row;  // as Python hands them over again
  std::vector<Real> gravity_mass;

  template <class T>
  static void keep(const Column<T>& column, std::vector<T>& kept) {
    kept.assign(column.data(), column.data() + column.size());
  }
  void come(const Vec& shift) {
    std::vector<Real> at(3 * std::size_t(model.node_count));
    for (Index i = 0; i < model.node_count; ++i) {
      const Vec x = position(i) + shift;
      at[3 * i] = x.x, at[3 * i + 1] = x.y, at[3 * i + 2] = x.z;
    }
    place_nodes(state, flags.data(), at.data());
    model.hex8.material.assign(material.data(), material.size());
    model.support.assign(support.data(), support.size());
    model.mass_row_first.assign(mass_row.data(), mass_row.size());
    model.gravity_mass.assign(gravity_mass.data(), gravity_mass.size());
    const Flag bonded_too[] = {1};
    bring_in(model, state, flags.data(), bonded_too);
  }
  std::size_t exposed() const { return state.search.exposed_face.size(); }
  Index live_pairs() const {
    Index count = 0;
    for (Index i = 0; i < model.quads.count; ++i)
      count += is_live(PairStatus(on_host(state.quads.status)[i]));
    return count;
  }
};

}  // namespace

TEST_CASE("a block that comes in covers a face, and bonds without force where it lies") {
  Later scene;
  CHECK(scene.exposed() == 5 + 5);
  scene.step(3000);
  scene.come({1e-3, 0, 2e-3});  // a little aside
  CHECK(scene.exposed() == 5 + 4 + 5);
  CHECK(scene.live_pairs() == 2);
  scene.model.gravity = {0, 0, 0};
  scene.model.damping.local = 0;
  const Vec before = scene.position(scene.first_node(scene.high));
  scene.step(1);
  CHECK(distance(scene.position(scene.first_node(scene.high)), before) < 1e-15);
}

TEST_CASE("a block that lies elsewhere comes in without bonds, and can be touched") {
  Later scene;
  scene.come({0, 0, 0.2});
  CHECK(scene.live_pairs() == 1);
  CHECK(scene.exposed() == 5 + 5 + 6);
}

}  // namespace cdem::test
