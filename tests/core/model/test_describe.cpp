// The list that names every array.
#include <set>

#include "core/model/describe.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("every array of model and state has a name, a column and a meaning of its own") {
  Model m;
  State s;
  std::set<std::string> names;
  std::set<const void*> columns;
  int count = 0, rebuilt = 0;
  const auto note = [&](const ColumnInfo& info, const auto& column) {
    names.insert(info.name);
    columns.insert(&column);
    CHECK(std::string(info.meaning).size() > 3);
    ++count;
  };
  describe(m, s, note, note, [&](const char* by, const ColumnInfo& info, const auto& column) {
    CHECK(std::string(by).size() > 3);
    note(info, column);
    ++rebuilt;
  });
  CHECK(count > 150);
  CHECK(rebuilt > 40);
  CHECK(int(names.size()) == count);
  CHECK(int(columns.size()) == count);
}

}  // namespace cdem::test
