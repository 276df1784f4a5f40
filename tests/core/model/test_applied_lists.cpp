// Rows of applied forces by node.
#include "core/model/applied_lists.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("a node sums its rows in their order, of faces and then of pores") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1});
  scene.build();
  WaterSet& w = given_of<Water>(scene.model);
  Water::take_counts(
      w, [](const char* name) { return std::string(name) == "wet_triangles.count" ? 2 : 0; });
  w.fields.resize(8);
  push(w.biot, 0.8);
  w.triangles.nodes.resize(3 * w.triangles.stride);
  const Index corners[2][3] = {{4, 5, 6}, {4, 6, 7}};
  for (std::size_t f = 0; f < 2; ++f)
    for (std::size_t k = 0; k < 3; ++k)
      on_host(w.triangles.nodes)[k * w.triangles.stride + f] = corners[f][k];
  list_applied(scene.model, scene.state);
  const AppliedForces& of = applied_of<Water>(scene.state);
  const auto first = on_host(of.first), row = on_host(of.row);
  CHECK(of.rows.size() == 4 * (6 + 8));
  const auto rows_of = [&](Index node) {
    return std::vector<Index>(row.begin() + first[node], row.begin() + first[node + 1]);
  };
  const auto nodes = on_host(scene.model.hex8.nodes);
  for (Index k = 0; k < 8; ++k) {
    const Index node = nodes[std::size_t(k) * scene.model.hex8.stride];
    std::vector<Index> expected;
    for (Index r = 0; r < 6; ++r)
      if (corners[r / 3][r % 3] == node) expected.push_back(r);
    expected.push_back(6 + k);
    CHECK(rows_of(node) == expected);
  }
}

}  // namespace cdem::test
