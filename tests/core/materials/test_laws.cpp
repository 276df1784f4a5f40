// The table of materials: each lane has the law and the constants of its own.
#include "core/materials/flow_by.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("elements of a lane have the constants of their materials") {
  const Real lambda[] = {1e9, 2e9, 3e9}, mu[] = {4e9, 5e9, 6e9};
  const Index law[] = {0, 0, 0};
  const MaterialTable table{lambda, mu, law, nullptr};
  IndexPack material;
  for (Index j = 0; j < lanes; ++j) material.id[j] = j % 3;
  const ElasticConstants<Pack> rocks = table.elastic(material);
  for (Index j = 0; j < lanes; ++j) {
    CHECK(rocks.lambda.n[j] == lambda[j % 3]);
    CHECK(rocks.mu.n[j] == mu[j % 3]);
    CHECK(table.elastic(j % 3).mu == mu[j % 3]);
  }
  CHECK(!any_of(table.laws(material) > Pack(0.0)));
}

TEST_CASE("an elastic material does not flow") {
  const Real lambda[] = {1e9}, mu[] = {4e9};
  const Index law[] = {0};
  const MaterialTable table{lambda, mu, law, nullptr};
  struct NoRows {
    Real at(Index) const { return 0; }
    Real size() const { return 1; }
  };
  CHECK(!flow(table, 0, 0.0, Sym3<Real>{1e12, -1e12, 0, 1e12, 0, 0}, NoRows{}).any);
}

}  // namespace cdem::test
