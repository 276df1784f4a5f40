// Sums of applied forces on nodes, and their work.
#include "core/nodes/sum_applied.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("work of applied forces is that of the mean force on the way of the last step") {
  const Real motion[8] = {0, 0, 0, 0, 1, 2, 3, 0}, out[8] = {1, 0, 0, 0, 0, 1, 0, 0};
  Real force[4] = {0, 0, 2, 0}, work = 10;
  const Index first[2] = {0, 2}, row[2] = {0, 1};
  const SumApplied sum{.nodes = {motion},
                       .first = first,
                       .row = row,
                       .rows = {out},
                       .out = nullptr,
                       .dt = 0.1,
                       .force = force,
                       .work = &work};
  sum(One{0});
  CHECK(distance(vector_at(force), Vec{1, 1, 0}) == 0);
  CHECK(work == doctest::Approx(10 + 0.1 * (0.5 * 1 + 0.5 * 2 + 1 * 3)).epsilon(1e-14));
}

}  // namespace cdem::test
