// Components of nodes whose velocity is given.
#include "core/nodes/supports.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Node 1 has support 0: x and z are given, z by curve 1.
struct Held {
  const Index support[3] = {-1, 0, -1};
  const Flag component[3] = {1, 0, 1};
  const Index curve[3] = {0, 0, 1};
  const Real velocity[3] = {2, 3, 4};
  const Real factor[2] = {1, 0.5};
  SupportColumns columns() const { return {support, component, curve, velocity, factor}; }
};

}  // namespace

TEST_CASE("a support gives some components, scaled by their curves") {
  const Held held;
  const SupportColumns supports = held.columns();
  const bool given[] = {true, false, true};
  for (Index axis = 0; axis < 3; ++axis) {
    CHECK(supports.given(1, axis) == given[axis]);
    CHECK(!supports.given(0, axis));
  }
  CHECK(supports.at(1, 0) == 2);
  CHECK(supports.at(1, 2) == 2);
}

TEST_CASE("given components take the place of those of a row, or leave it") {
  const Held held;
  const SupportColumns supports = held.columns();
  const Row row = Row::of(7, 8, 9);
  CHECK(distance(supports.with_given(1, row).vector(), Vec{2, 8, 2}) == 0);
  CHECK(distance(supports.without_given(1, row).vector(), Vec{0, 8, 0}) == 0);
  CHECK(distance(supports.with_given(0, row).vector(), Vec{7, 8, 9}) == 0);
  CHECK(distance(supports.without_given(2, row).vector(), Vec{7, 8, 9}) == 0);
}

}  // namespace cdem::test
