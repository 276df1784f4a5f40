// What is done with whole arrays against the standard library, for any size and number of threads.
#include <numeric>
#include <vector>

#include "core/base/openmp.hpp"
#include "core/base/primitive_loops.hpp"
#include "core/base/primitives.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

struct NumberAt {
  const Real* numbers;
  CDEM_HD Real operator()(One item) const { return numbers[item.i]; }
};
struct IsOdd {
  const Index* numbers;
  CDEM_HD bool operator()(One item) const { return numbers[item.i] % 2 != 0; }
};
/// Every item goes to two rows, or to none.
struct ToRows {
  const Index* row;
  template <class Do>
  CDEM_HD void visit(One item, const Do& act) const {
    if (row[2 * item.i] < 0) return;
    for (Index k = 2 * item.i; k < 2 * item.i + 2; ++k) act(row[k], k);
  }
};

/// A row has as many items as its number says: 1000 times the row, and the place in it.
struct ItemsOfRow {
  const Index* counts;
  template <class Do>
  CDEM_HD void visit(One row, const Do& act) const {
    for (Index k = 0; k < counts[row.i]; ++k) act(std::int64_t(row.i) * 1000 + k);
  }
};
/// Halves even items, and drops the others.
struct HalveEven {
  CDEM_HD bool operator()(std::int64_t& item) const {
    if (item % 2 != 0) return false;
    item /= 2;
    return true;
  }
};

template <class T>
Column<T> column_of(const std::vector<T>& items) {
  Column<T> column;
  column.assign(items.data(), items.size());
  return column;
}

/// Sizes around those at which loops change, and at random up to a million.
std::vector<Index> sizes(Random& random) {
  std::vector<Index> all{0,
                         1,
                         2,
                         lanes + 1,
                         worth_threads - 1,
                         worth_threads,
                         5 * worth_threads,
                         64 * worth_threads + 7};
  for (const Index most : {300, 30000, 1000000}) all.push_back(random.below(most));
  return all;
}

std::vector<Index> random_indices(Random& random, Index count, Index below) {
  std::vector<Index> all(count);
  for (Index& one : all) one = random.below(below);
  return all;
}

/// Run a check for several sizes, each on several numbers of threads.
template <class Check>
void for_sizes_and_threads(std::uint64_t seed, const Check& check) {
  const int before = omp_get_max_threads();
  Random random(seed);
  for (const Index count : sizes(random))
    for (const int threads : {1, 2, 3, 7}) {
      omp_set_num_threads(threads);
      CAPTURE(count);
      CAPTURE(threads);
      check(random, count);
    }
  omp_set_num_threads(before);
}

}  // namespace

TEST_CASE("set_all sets all and no more") {
  for (const Index count : {0, 1, 3 * worth_threads}) {
    Column<Index> items;
    items.resize(count + 1, 7);
    set_all({}, count, items.data(), Index(3));
    CHECK(std::count(items.data(), items.data() + count + 1, 3) == count);
    CHECK(on_host(items)[count] == 7);
  }
}

TEST_CASE("scan gives starts of rows and their sum, in its own place as well") {
  for_sizes_and_threads(1, [](Random& random, Index count) {
    const std::vector<Index> counts = random_indices(random, count, 9);
    std::vector<Index> expected(count + 1);
    std::partial_sum(counts.begin(), counts.end(), expected.begin() + 1);
    const Column<Index> given = column_of(counts);
    Column<Index> first, own;
    first.resize(count + 1, -1);
    own.resize(count + 1, -1);
    std::copy(counts.begin(), counts.end(), own.data() + 1);
    CHECK(scan({}, count, given.data(), first.data()) == expected.back());
    CHECK(fetch(first) == expected);
    CHECK(scan({}, count, own.data() + 1, own.data()) == expected.back());
    CHECK(fetch(own) == expected);
  });
}

TEST_CASE("most is the first of the largest numbers") {
  for_sizes_and_threads(2, [](Random& random, Index count) {
    std::vector<Real> numbers(count);
    for (Real& x : numbers) x = Real(random.below(1 + count / 3)) - 5;  // many are equal
    const Column<Real> given = column_of(numbers);
    const Most found = most({}, count, NumberAt{given.data()}, nullptr);
    const auto largest = std::max_element(numbers.begin(), numbers.end());
    CHECK(found.item == (count == 0 ? -1 : Index(largest - numbers.begin())));
    if (count > 0) CHECK(found.value == *largest);
  });
}

TEST_CASE("what is no number is not the most, nor is -infinity") {
  constexpr Real infinity = std::numeric_limits<Real>::infinity();
  const Real none = std::numeric_limits<Real>::quiet_NaN();
  const auto most_of_these = [](const std::vector<Real>& numbers) {
    const Column<Real> given = column_of(numbers);
    return most({}, Index(numbers.size()), NumberAt{given.data()}, nullptr).item;
  };
  CHECK(most_of_these({none, -2, none, -1, none}) == 3);
  CHECK(most_of_these({none, -infinity}) == -1);
  CHECK(most_of_these({1, infinity, none, infinity}) == 1);
}

TEST_CASE("select_items lists the items for which a kernel holds") {
  for_sizes_and_threads(3, [](Random& random, Index count) {
    const std::vector<Index> numbers = random_indices(random, count, 1000);
    std::vector<Index> expected;
    std::vector<Flag> odd(count);
    for (Index i = 0; i < count; ++i)
      if (numbers[i] % 2 != 0) expected.push_back(i), odd[i] = Flag(1 + numbers[i] % 3);
    const Column<Index> given = column_of(numbers);
    const Column<Flag> flags = column_of(odd);
    Column<Index> list;
    select_items({}, count, IsOdd{given.data()}, list);
    CHECK(fetch(list) == expected);
    select_items({}, count, IsSet{flags.data()}, list);
    CHECK(fetch(list) == expected);
  });
}

TEST_CASE("list_items lists what rows have, row after row; keep_items keeps and changes some") {
  for_sizes_and_threads(6, [](Random& random, Index count) {
    std::vector<Index> counts = random_indices(random, count, 4);
    if (count > 9) counts[9] = 700;
    std::vector<std::int64_t> expected, halves;
    for (Index row = 0; row < count; ++row)
      for (Index k = 0; k < counts[row]; ++k) expected.push_back(std::int64_t(row) * 1000 + k);
    for (const std::int64_t item : expected)
      if (item % 2 == 0) halves.push_back(item / 2);
    const Column<Index> given = column_of(counts);
    Column<std::int64_t> items;
    list_items({}, count, ItemsOfRow{given.data()}, items);
    CHECK(fetch(items) == expected);
    Column<Index> first;
    Column<std::int64_t> again;
    list_items({}, count, ItemsOfRow{given.data()}, first, again);
    CHECK(fetch(again) == expected);
    const std::vector<Index> starts = fetch(first);
    REQUIRE(Index(starts.size()) == count + 1);
    CHECK(starts[0] == 0);
    bool apart = true;
    for (Index row = 0; row < count; ++row)
      apart = apart && starts[row + 1] == starts[row] + counts[row];
    CHECK(apart);
    keep_items({}, HalveEven{}, items);
    CHECK(fetch(items) == halves);
  });
}

TEST_CASE("sort_pairs sorts by all bits of a key, and keeps the order of those with one key") {
  for_sizes_and_threads(4, [](Random& random, Index count) {
    std::vector<std::pair<std::uint64_t, Index>> pairs(count);
    for (Index i = 0; i < count; ++i)
      pairs[i] = {std::uint64_t(random.below(1 + count / 2)) * 0x9e3779b97f4a7c15u, i};
    Column<std::uint64_t> keys;
    Column<Index> values;
    keys.resize(count);
    values.resize(count);
    for (Index i = 0; i < count; ++i)
      on_host(keys)[i] = pairs[i].first, on_host(values)[i] = pairs[i].second;
    sort_pairs({}, count, keys.data(), values.data());
    std::sort(pairs.begin(), pairs.end());  // values ascend: as a stable sort by keys
    bool same = true;
    for (Index i = 0; i < count; ++i)
      same = same && on_host(keys)[i] == pairs[i].first && on_host(values)[i] == pairs[i].second;
    CHECK(same);
  });
}

TEST_CASE("list_rows brings numbers into their rows, short and long ones, ascending") {
  for_sizes_and_threads(5, [](Random& random, Index count) {
    const Index items = count / 2, rows = 1 + count / (random.below(2) == 0 ? 7 : 2000);
    std::vector<Index> row = random_indices(random, 2 * items, rows);
    for (Index i = 0; i < items; i += 5) row[2 * i] = -1;
    std::vector<std::vector<Index>> expected(rows);
    for (Index k = 0; k < 2 * items; ++k)
      if (row[k / 2 * 2] >= 0) expected[row[k]].push_back(k);
    const Column<Index> given = column_of(row);
    Column<Index> first, number;
    list_rows({}, items, 2 * items, rows, ToRows{given.data()}, first, number);
    REQUIRE(first.size() == std::size_t(rows) + 1);
    CHECK(on_host(first)[0] == 0);
    CHECK(std::size_t(on_host(first)[rows]) == number.size());
    const auto is_expected = [&] {
      bool same = true;
      for (Index r = 0; r < rows; ++r)
        same = same && expected[r] == std::vector<Index>(number.data() + on_host(first)[r],
                                                         number.data() + on_host(first)[r + 1]);
      return same;
    };
    CHECK(is_expected());
    first = {};
    list_rows_in_room({}, items, 2 * items, rows, ToRows{given.data()}, first, number);
    CHECK(number.size() == 2 * std::size_t(items));
    CHECK(is_expected());
  });
}

}  // namespace cdem::test
