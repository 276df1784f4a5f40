// Loops over the sets of elements and of bonded pairs.
#include <set>
#include <string>

#include "core/model/force_sets.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

struct Mixed : Scene {
  Mixed() {
    bonded = true;
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({0, 0, 1}, {1, 1, 1});
    add<Tet4>({{{9, 0, 0}, {10, 0, 0}, {9, 1, 0}, {9, 0, 1}}});
    add<Tet4>({{{9, 0, 0}, {9, 1, 0}, {10, 0, 0}, {9, 0, -1}}});
    build();
  }
};

}  // namespace

TEST_CASE("every set is visited once, and all corner rows belong to one item") {
  Mixed mixed;
  std::set<std::string> names;
  std::vector<Index> owners(mixed.model.corner_rows);
  Index active = 0;
  for_each_set(mixed.model, mixed.state, [&](const auto& kind, const auto&, const auto&) {
    CHECK(names.insert(kind.name).second);
  });
  for_each_row_set(mixed.model, mixed.state, [&](auto, const auto& set, const auto& state) {
    const auto is_active = activity(state);
    const auto for_each_corner_row = corner_rows_of(set);
    for (Index i = 0; i < set.count; ++i) {
      for_each_corner_row(i, [&](Index row) { ++owners[row]; });
      active += is_active(i);
    }
  });
  CHECK(names == std::set<std::string>{"tet4", "pyramid5", "wedge6", "hex8", "triangles", "quads",
                                       "overlaps", "bolts"});
  CHECK(owners == std::vector<Index>(owners.size(), 1));
  CHECK(active == 1 + 1);
  CHECK(element_corner_count(mixed.model, mixed.state) == 2 * 8 + 2 * 4);
}

TEST_CASE("items name their nodes, and what a pair stiffens them by") {
  const Mixed mixed;
  std::vector<Index> visits(mixed.model.node_count);
  for_each_set(mixed.model, mixed.state, [&](const auto&, const auto& set, const auto&) {
    const auto for_each_node = nodes_of(mixed.model, set);
    for (Index i = 0; i < set.count; ++i) for_each_node(i, [&](Index node) { ++visits[node]; });
  });
  for (Index i = 0; i < mixed.model.node_count; ++i) {
    const Vec x = mixed.position(i);
    const bool at_bond = i < 16 ? x.z == 1 : x.z == 0;
    CHECK(visits[i] == (at_bond ? 2 : 1));
  }
  Real sum = 0;
  const PairSet& p = mixed.model.triangles;
  stiffness_of(mixed.model, p)(0, [&](Index, Real k) { sum += k; });
  CHECK(relative_error(sum, 2 * on_host(p.stiffness)[0] * on_host(p.area)[0]) < 1e-15);
}

TEST_CASE("a released pair is not active") {
  Mixed mixed;
  on_host(mixed.state.quads.status)[0] = 0;
  CHECK(!activity(mixed.state.quads)(0));
  CHECK(activity(mixed.state.triangles)(0));
}

}  // namespace cdem::test
