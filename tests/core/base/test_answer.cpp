// Values that kernels write and the host reads.
#include "core/base/answer.hpp"
#include "core/base/any_item.hpp"
#include "core/base/column.hpp"
#include "core/base/parallel_loops.hpp"
#include "core/base/views.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

struct Lies {
  const Real* x;
  Real low, high;
  CDEM_HD bool operator()(One item) const { return x[item.i] > low && x[item.i] < high; }
};

struct Three {
  Flag low = 0, middle = 0, high = 0;
};

}  // namespace

TEST_CASE("questions that are asked together are answered each, whenever they are read") {
  Column<Real> x;
  x.assign({0.5, 0.6, 2.5});
  Answer<Three> answer;
  for (int times = 0; times < 3; ++times) {
    answer.set({}, {});
    Three* const flags = answer.data();
    raise_if_any({}, 3, Lies{x.data(), 0, 1}, &flags->low);
    raise_if_any({}, 3, Lies{x.data(), 1, 2}, &flags->middle);
    raise_if_any({}, 3, Lies{x.data(), 2, 3}, &flags->high);
    raise_if_any({}, 0, Lies{x.data(), 0, 3}, &flags->middle);
    const Three found = answer.read({});
    CHECK(found.low == 1);
    CHECK(found.middle == 0);
    CHECK(found.high == 1);
  }
  answer.set({}, {});
  CHECK(answer.read({}).low == 0);
}

TEST_CASE("an answer moves with its memory, and what is given back is taken again") {
  Answer<Index> one;
  one.set({}, 7);
  const Index* const place = one.data();
  Answer<Index> other(std::move(one));
  CHECK(other.read({}) == 7);
  one = std::move(other);
  CHECK(one.data() == place);
  one = Answer<Index>();
  Answer<Index> next;
  CHECK(next.data() == place);
}

}  // namespace cdem::test
