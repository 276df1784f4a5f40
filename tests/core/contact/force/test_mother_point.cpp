// The point of the mother face at which a semi-spring acts.
#include "core/contact/force/mother_point.hpp"
#include "core/contact/geometry/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

struct BlocksInTouch : Scene {
  BlocksInTouch() {
    Random random(1);
    add_box({0, 0, 0}, {1, 2, 3});
    add_tet(random, {5, 0, 0}, 1);
    build();
    for (Index b = 0; b < 2; ++b) set_motion(b, random.vector(1), random.vector(1));
    start();
    state.dt_last = 0.01;
    for (Index i = 0; i < model.node_count; ++i) on_host(model.mass)[i] = 1 + i;
  }
  template <class T, class Ids>
  MotherPoint<T> at(const Ids& m, const Ids& slot) const {
    return MotherPoint<T>::at(face_columns(model, state), face_geometry(state), model.rules,
                              state.springs.rim_action.data(), model.mass.data(), m, slot);
  }
};

}  // namespace

TEST_CASE("without action coefficient the point is the vertex, with its mass") {
  const BlocksInTouch blocks;
  for (Index m = 0; m < 10; ++m)
    for (Index k = 0; k < 3; ++k) {
      const Index node = on_host(blocks.state.search.exposed)[m].corner[k];
      const auto p = blocks.at<Real>(m, 4 * m + k);
      CHECK(distance(p.x, blocks.position(node)) == 0);
      CHECK(distance(p.v, blocks.velocity(node)) == 0);
      CHECK(distance(p.x_old, p.x - Real(0.01) * p.v) < 1e-15);
      CHECK(relative_error(p.inverse_mass, 1.0 / (1 + node)) < 1e-15);
    }
}

TEST_CASE("the coefficient moves the point towards the centre, with weights that sum to one") {
  BlocksInTouch blocks;
  blocks.model.rules.action = 0.3;
  for (Index m = 0; m < 10; ++m) {
    const ExposedRow& row = on_host(blocks.state.search.exposed)[m];
    const Index count = row.count();
    Vec center{0, 0, 0};
    for (Index k = 0; k < count; ++k)
      center = center + Real(1.0 / count) * blocks.position(row.corner[k]);
    for (Index k = 0; k < count; ++k) {
      const auto p = blocks.at<Real>(m, 4 * m + k);
      const Vec vertex = blocks.position(row.corner[k]);
      CHECK(distance(p.x, vertex + Real(0.3) * (center - vertex)) < 5e-15);
      Real inverse = 0;
      for (Index j = 0; j < count; ++j) {
        const Real w = 0.3 / count + (j == k ? 0.7 : 0);
        inverse += w * w / (1 + row.corner[j]);
      }
      CHECK(relative_error(p.inverse_mass, inverse) < 1e-14);
    }
  }
}

TEST_CASE("points of a lane are those of its slots") {
  Random random(2);
  for (const Real action : {0.0, 0.3}) {
    BlocksInTouch blocks;
    blocks.model.rules.action = action;
    IndexPack m, slot;
    for (Index j = 0; j < lanes; ++j) {
      m.id[j] = random.below(10);
      slot.id[j] = 4 * m.id[j] + random.below(3);
    }
    const auto pack = blocks.at<Pack>(m, slot);
    for (Index j = 0; j < lanes; ++j) {
      const auto p = blocks.at<Real>(m.id[j], slot.id[j]);
      CHECK(same_bits(pack.x.y.n[j], p.x.y));
      CHECK(same_bits(pack.x_old.z.n[j], p.x_old.z));
      CHECK(same_bits(pack.v.x.n[j], p.v.x));
      CHECK(same_bits(pack.inverse_mass.n[j], p.inverse_mass));
    }
  }
}

TEST_CASE("a contact held at a rim has an action coefficient of its own") {
  BlocksInTouch blocks;
  blocks.model.rules.action = 0.01;
  const Index m = 2, corner = on_host(blocks.state.search.exposed)[m].corner[1];
  on_host(blocks.state.springs.rim_action)[4 * m + 1] = 0.4;
  Vec center{0, 0, 0};
  for (Index k = 0; k < 4; ++k)
    center =
        center + Real(0.25) * blocks.position(on_host(blocks.state.search.exposed)[m].corner[k]);
  const Vec vertex = blocks.position(corner);
  CHECK(distance(blocks.at<Real>(m, 4 * m + 1).x, vertex + Real(0.4) * (center - vertex)) < 5e-15);
  const Index beside = on_host(blocks.state.search.exposed)[m].corner[2];
  const Vec other = blocks.position(beside);
  CHECK(distance(blocks.at<Real>(m, 4 * m + 2).x, other + Real(0.01) * (center - other)) < 5e-15);
}

}  // namespace cdem::test
