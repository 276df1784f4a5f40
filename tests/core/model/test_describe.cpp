// The lists that name every array.
#include <set>

#include "core/model/describe.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("every array of the model has a name and a column of its own") {
  Model m;
  std::set<std::string> names;
  std::set<const void*> columns;
  int count = 0;
  describe(m, [&](const std::string& name, auto& column) {
    names.insert(name);
    columns.insert(&column);
    ++count;
  });
  CHECK(count > 60);
  CHECK(int(names.size()) == count);
  CHECK(int(columns.size()) == count);
}

TEST_CASE("every array of the state has a name, a column and a meaning of its own") {
  State s;
  std::set<std::string> names;
  std::set<const void*> columns;
  int count = 0;
  describe(s, [&](const std::string& name, auto& column, const char* meaning) {
    names.insert(name);
    columns.insert(&column);
    CHECK(std::string(meaning).size() > 3);
    ++count;
  });
  CHECK(count > 60);
  CHECK(int(names.size()) == count);
  CHECK(int(columns.size()) == count);
}

}  // namespace cdem::test
