// Loops over kernels run for every item once, in whole lanes and a remainder.
#include <algorithm>
#include <atomic>
#include <type_traits>
#include <vector>

#include "core/base/openmp.hpp"
#include "core/base/parallel_loops.hpp"
#include "core/base/views.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Counts how often each item runs, and how many of them in lanes.
struct CountVisits {
  Index* visits;
  Index* in_lanes;

  void operator()(One item) const { std::atomic_ref(visits[item.i]).fetch_add(1); }
  void operator()(Lane item) const {
    for (Index j = 0; j < lanes; ++j) {
      std::atomic_ref(visits[item.i + j]).fetch_add(1);
      std::atomic_ref(in_lanes[item.i + j]).fetch_add(1);
    }
  }
};

/// Selects every third item of ragged rows, and counts what it runs for.
struct CountSelected {
  const Index* first;
  Index *visits, *row_of, *in_lanes;

  Range items(Index row) const { return {first[row], first[row + 1]}; }
  bool selects(Index, Index id) const { return id % 3 == 0; }
  template <class I>
  void operator()(const I& item) const {
    for_lanes(item, [&](Index, Index row, Index id) {
      std::atomic_ref(visits[id]).fetch_add(1);
      row_of[id] = row;
      if constexpr (std::is_same_v<I, SelectedLane>) in_lanes[id] = 1;
    });
  }
};

/// Like a law of the core, written once for any item.
struct Scale {
  InOutTable x;
  template <class I>
  void operator()(I i) const {
    x.set(0, i, sqrt_of(Number<I>(0.3) * x.at(0, i) + Number<I>(0.7)));
  }
};

#if defined(CDEM_CPU)
constexpr bool runs_lanes = true;
#else
constexpr bool runs_lanes = false;
#endif

/// Counts that threads need not wait for, below and above the number that is worth them.
const Index counts[] = {0,
                        1,
                        lanes - 1,
                        lanes,
                        lanes + 1,
                        3 * lanes + 1,
                        worth_threads - 1,
                        worth_threads,
                        2 * worth_threads + 5};

std::vector<Index> ones(std::size_t count) { return std::vector<Index>(count, 1); }

template <class Test>
void on_threads(const Test& test) {
  const int threads = omp_get_max_threads();
  for (const int on : {1, 3}) {
    omp_set_num_threads(on);
    for (const Index count : counts) test(count);
  }
  omp_set_num_threads(threads);
}

}  // namespace

TEST_CASE("blocks are found by their numbers") {
  const std::vector<Index> list{2, 3, 7, 20, 21};
  const Blocks some{list.data(), Index(list.size())}, every{}, none{list.data(), 0};
  for (Index begin = 0; begin < 24; ++begin) {
    const bool listed = std::find(list.begin(), list.end(), begin) != list.end();
    CHECK(some.has(begin) == listed);
    CHECK(every.has(begin));
    CHECK(!none.has(begin));
    for (Index end = begin; end < 24; ++end) {
      const Range found = some.between(begin, end);
      CHECK(found.first == std::lower_bound(list.begin(), list.end(), begin) - list.begin());
      CHECK(found.last == std::lower_bound(list.begin(), list.end(), end) - list.begin());
      CHECK(every.between(begin, end).last == end);
    }
  }
}

TEST_CASE("for_each_lane runs every item once, all but the remainder in lanes") {
  on_threads([](Index count) {
    std::vector<Index> visits(count), in_lanes(count);
    for_each_lane({}, count, CountVisits{visits.data(), in_lanes.data()});
    CHECK(visits == ones(count));
    CHECK(std::count(in_lanes.begin(), in_lanes.end(), 1) ==
          (runs_lanes ? count - count % lanes : 0));
  });
}

TEST_CASE("for_each_item runs every item once, by itself") {
  on_threads([](Index count) {
    std::vector<Index> visits(count), in_lanes(count);
    for_each_item({}, count, CountVisits{visits.data(), in_lanes.data()});
    CHECK(visits == ones(count));
    CHECK(std::count(in_lanes.begin(), in_lanes.end(), 1) == 0);
  });
}

TEST_CASE("loops over blocks run the items of these blocks once, and no others") {
  on_threads([](Index count) {
    const Index blocks = (count + block_size - 1) / block_size;
    std::vector<Index> some;
    for (Index b = 0; b < blocks; ++b)
      if (b % 3 != 1 || b + 1 == blocks) some.push_back(b);
    const Index none = 0;
    const Blocks list{some.empty() ? &none : some.data(), Index(some.size())};
    std::vector<Index> expected(count);
    for (const Index b : some)
      for (Index i = b * block_size; i < std::min((b + 1) * block_size, count); ++i)
        expected[i] = 1;

    std::vector<Index> visits(count), in_lanes(count);
    for_each_lane({}, count, list, CountVisits{visits.data(), in_lanes.data()});
    CHECK(visits == expected);
    visits.assign(count, 0);
    for_each_item({}, count, list, CountVisits{visits.data(), in_lanes.data()});
    CHECK(visits == expected);

    visits.assign(count, 0);  // no list stands for all
    for_each_lane({}, count, Blocks{}, CountVisits{visits.data(), in_lanes.data()});
    for_each_item({}, count, Blocks{}, CountVisits{visits.data(), in_lanes.data()});
    CHECK(visits == std::vector<Index>(count, 2));
  });
}

TEST_CASE("for_each_selected runs what the kernel selects once, with its row") {
  on_threads([](Index count) {
    Random random(1);
    std::vector<Index> first(count + 1);
    for (Index row = 0; row < count; ++row) first[row + 1] = first[row] + random.below(5);
    const Index items = first[count];
    std::vector<Index> visits(items), row_of(items, -1), in_lanes(items);
    for_each_selected({}, count,
                      CountSelected{first.data(), visits.data(), row_of.data(), in_lanes.data()});
    Index selected = 0;
    for (Index row = 0; row < count; ++row)
      for (Index id = first[row]; id < first[row + 1]; ++id) {
        CHECK(visits[id] == (id % 3 == 0));
        CHECK(row_of[id] == (id % 3 == 0 ? row : -1));
        selected += id % 3 == 0;
      }
    const Index whole = Index(std::count(in_lanes.begin(), in_lanes.end(), 1));
    CHECK(whole % lanes == 0);
    if (runs_lanes && (omp_get_max_threads() == 1 || count < worth_threads))
      CHECK(selected - whole < lanes);
  });
}

TEST_CASE("a kernel gives the same bits one by one, in a lane and in a remainder") {
  Random random(2);
  const Index count = 2 * lanes + 1;
  Real in_lanes[3 * 8], one_by_one[3 * 8];
  for (Index i = 0; i < count; ++i) in_lanes[i] = one_by_one[i] = random.between(0, 1);
  for_each_lane({}, count, Scale{{in_lanes, 0}});
  for_each_item({}, count, Scale{{one_by_one, 0}});
  for (Index i = 0; i < count; ++i) CHECK(same_bits(in_lanes[i], one_by_one[i]));
}

}  // namespace cdem::test
