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
    for (Index i = 0; i < set.count; ++i) {
      for_each_corner_row(set, i, [&](Index row) { ++owners[row]; });
      active += is_active(state, i);
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
    for (Index i = 0; i < set.count; ++i)
      for_each_node(mixed.model, set, i, [&](Index node) { ++visits[node]; });
  });
  for (Index i = 0; i < mixed.model.node_count; ++i) {
    const Vec x = mixed.position(i);
    const bool at_bond = i < 16 ? x.z == 1 : x.z == 0;
    CHECK(visits[i] == (at_bond ? 2 : 1));
  }
  Real sum = 0;
  for_each_stiffness(mixed.model, mixed.model.triangles, 0, [&](Index, Real k) { sum += k; });
  const PairSet& p = mixed.model.triangles;
  CHECK(relative_error(sum, 2 * p.stiffness[0] * p.area[0]) < 1e-15);
}

TEST_CASE("a released pair is not active") {
  Mixed mixed;
  mixed.state.quads.status[0] = 0;
  CHECK(!is_active(mixed.state.quads, 0));
  CHECK(is_active(mixed.state.triangles, 0));
}

}  // namespace cdem::test
