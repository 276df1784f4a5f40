// Matrices of elements: forces change by them where a node moves a little.
#include "core/elements/views.hpp"
#include "core/rest/element_matrix.hpp"
#include "tests/core/rest/moved_nodes.hpp"

namespace cdem::test {

namespace {

template <class Shape>
ElementSet& set_of(Model& m) {
  if constexpr (Shape::nodes == 4) return m.tet4;
  if constexpr (Shape::nodes == 5) return m.pyramid5;
  if constexpr (Shape::nodes == 6) return m.wedge6;
  if constexpr (Shape::nodes == 8) return m.hex8;
}

}  // namespace

TEST_CASE_TEMPLATE("an element that is turned", Shape, Tet4, Pyramid5, Wedge6, Hex8) {
  Random random(3);
  Scene scene;
  std::array<Vec, Shape::nodes> x = Reference<Shape>::corners();
  for (Vec& corner : x) corner = corner + random.vector(0.1);
  scene.add<Shape>(x);
  scene.build();
  turn(scene, random.rotation());
  const auto columns = element_columns<Shape>(scene.model, scene.state, set_of<Shape>(scene.model));
  const CorotationalForce<Shape, FollowRotation> force{
      .columns = columns, .damping_time = 0, .dt = 1, .damping_work = {}, .flow = {}};
  check_matrix(scene, element_matrix<Shape>(columns, One{0}), [&] {
    const auto now = force.forces(One{0});
    return std::vector<Vec>(now.f, now.f + Shape::nodes);
  });
}

}  // namespace cdem::test
