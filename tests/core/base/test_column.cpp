// Owned arrays keep their content while they grow.
#include <numeric>
#include <utility>

#include "core/base/column.hpp"
#include "core/base/views.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a column that grows keeps what it holds, and fills what is new") {
  Column<Index> column;
  CHECK(column.size() == 0);
  for (Index i = 0; i < 1000; ++i) column.resize(i + 1, i);
  column.resize(1500, -1);
  REQUIRE(column.size() == 1500);
  for (Index i = 0; i < 1000; ++i) CHECK(on_host(column)[i] == i);
  for (Index i = 1000; i < 1500; ++i) CHECK(on_host(column)[i] == -1);
  column.resize(10);
  column.resize(12, 7);
  CHECK(on_host(column)[9] == 9);
  CHECK(on_host(column)[10] == 7);
  CHECK(on_host(column)[11] == 7);
}

TEST_CASE("host code has the items of a column by name, or a copy of them") {
  Column<Index> column;
  column.assign({1, 2, 3});
  const auto items = on_host(column);
  items[1] = 5;
  CHECK(items.size() == 3);
  CHECK(std::accumulate(items.begin(), items.end(), 0) == 9);
  CHECK(items.data() == column.data());
  CHECK(fetch(column) == std::vector<Index>{1, 5, 3});
  CHECK(on_host(std::as_const(column))[1] == 5);
}

TEST_CASE("host code does not index a column by accident") {
  const auto is_indexed = []<class T>(T&& column) { return requires { column[0]; }; };
  CHECK(!is_indexed(Column<Real>{}));
  CHECK(is_indexed(OnHost<Real>(nullptr, 0)));
}

TEST_CASE("a view of arrays is given to the host as it is") {
  Column<Real> column;
  column.assign({1, 2, 3, 4, 5, 6, 7, 8});
  const InMotion nodes = on_host(InMotion{column.data()});
  CHECK(nodes.velocity(0).x == 5);
}

TEST_CASE("a column may be read beyond its end by a lane") {
  Column<Real> column;
  column.resize(1, 4.0);
  const Real* first = on_host(column).data();
  for (Index j = 1; j < lanes; ++j) CHECK(first[j] == 0);
}

TEST_CASE("a column is assigned from its own view, and from other memory") {
  Column<Real> column;
  const Real other[] = {1, 2, 3, 4, 5};
  column.assign(other, 5);
  column.assign(column.data(), column.size());
  CHECK(column.size() == 5);
  CHECK(on_host(column)[4] == 5);
  column.assign(column.data(), 3);
  CHECK(column.size() == 3);
  CHECK(on_host(column)[2] == 3);
  column.assign(nullptr, 0);
  CHECK(column.size() == 0);
}

TEST_CASE("a column that is moved leaves its content to the other") {
  Column<Index> a;
  a.assign({5});
  Column<Index> b(std::move(a));
  CHECK(b.size() == 1);
  CHECK(on_host(b)[0] == 5);
  Column<Index> c;
  c.assign({6, 7});
  c = std::move(b);
  CHECK(c.size() == 1);
  CHECK(on_host(c)[0] == 5);
  Column<Index> d;
  d.swap(c);
  CHECK(c.size() == 0);
  CHECK(on_host(d)[0] == 5);
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
