// Does a kernel hold for any item: in lanes, in the remainder, for none.
#include "core/base/any_item.hpp"
#include "core/base/column.hpp"
#include "core/base/parallel_loops.hpp"
#include "core/base/views.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

struct IsPositive {
  InTable x;
  template <class I>
  CDEM_HD auto operator()(I item) const {
    return x.at(0, item) > Number<I>(0.0);
  }
};

}  // namespace

TEST_CASE("any_item finds one item wherever it is, and none where there is none") {
  for (const Index count : {0, 1, 2 * lanes, 2 * lanes + 1, 2 * worth_threads + 5}) {
    Column<Real> x;
    x.resize(std::size_t(count));
    const IsPositive kernel{{x.data(), 0}};
    CHECK(!any_item({}, count, kernel));
    for (const Index i : {0, count / 2, count - 1}) {
      if (i < 0 || i >= count) continue;
      on_host(x)[i] = 1;
      CHECK(any_item({}, count, kernel));
      on_host(x)[i] = 0;
    }
    CHECK(!any_item({}, count, kernel));
  }
}

}  // namespace cdem::test
