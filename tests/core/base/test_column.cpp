// Owned arrays keep their content while they grow.
#include <utility>

#include "core/base/column.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a column that grows keeps what it holds, and fills what is new") {
  Column<Index> column;
  CHECK(column.size() == 0);
  for (Index i = 0; i < 1000; ++i) column.push(i);
  column.resize(1500, -1);
  REQUIRE(column.size() == 1500);
  for (Index i = 0; i < 1000; ++i) CHECK(column[i] == i);
  for (Index i = 1000; i < 1500; ++i) CHECK(column[i] == -1);
  column.resize(10);
  column.resize(12, 7);
  CHECK(column[9] == 9);
  CHECK(column[10] == 7);
  CHECK(column[11] == 7);
  column.fill(3);
  for (const Index i : {0, 5, 11}) CHECK(column[i] == 3);
}

TEST_CASE("a column may be read beyond its end by a lane") {
  Column<Real> column;
  column.resize(1, 4.0);
  for (Index j = 1; j < lanes; ++j) CHECK(column.data()[j] == 0);
}

TEST_CASE("a column is assigned from its own view, and from other memory") {
  Column<Real> column;
  const Real other[] = {1, 2, 3, 4, 5};
  column.assign(other, 5);
  column.assign(column.data(), column.size());
  CHECK(column.size() == 5);
  CHECK(column[4] == 5);
  column.assign(column.data(), 3);
  CHECK(column.size() == 3);
  CHECK(column[2] == 3);
  column.assign(nullptr, 0);
  CHECK(column.size() == 0);
}

TEST_CASE("a column that is moved leaves its content to the other") {
  Column<Index> a;
  a.push(5);
  Column<Index> b(std::move(a));
  CHECK(b.size() == 1);
  CHECK(b[0] == 5);
  Column<Index> c;
  c.push(6);
  c.push(7);
  c = std::move(b);
  CHECK(c.size() == 1);
  CHECK(c[0] == 5);
  Column<Index> d;
  d.swap(c);
  CHECK(c.size() == 0);
  CHECK(d[0] == 5);
}

TEST_CASE("the stride of a table holds whole blocks, and no multiple of 4096 bytes") {
  for (Index count = 0; count < 5000; ++count) {
    const Index stride = padded_stride(count);
    CHECK(stride >= count);
    CHECK(stride < count + 16);
    CHECK(stride % 8 == 0);
    CHECK((stride % 512 != 0 || stride == 0));
  }
}

}  // namespace cdem::test
