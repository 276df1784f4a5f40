// Planted faults that the emulated device must find: races, host code in a run or that does not
// wait, memory of the host.
#include "core/base/emulated.hpp"

#if defined(CDEM_EMULATED)

#include <sys/wait.h>
#include <unistd.h>

#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/base/column.hpp"
#include "core/base/parallel_loops.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Each item writes to its own place what `from` places further stood there before: a race, but for
/// 0.
struct Shift {
  Real* x;
  Index count, from;
  CDEM_HD void operator()(One item) const { x[item.i] = x[(item.i + from) % count] + 1; }
};

/// All items write the same number to the same place.
struct WriteOne {
  Flag* flag;
  CDEM_HD void operator()(One) const { *flag = 1; }
};
/// The same by what is made for it.
struct SetOne {
  Flag* flag;
  CDEM_HD void operator()(One) const { set(*flag); }
};
/// And then reads it.
struct SetAndRead {
  Flag* flag;
  Index* found;
  CDEM_HD void operator()(One item) const {
    found[item.i] = *flag;
    set(*flag);
  }
};

/// Each item lowers one number that all look at: to follow labels in any order.
struct LookAndLower {
  Index *number, *found;
  bool plainly;
  CDEM_HD void operator()(One item) const {
    found[item.i] = plainly ? *number : peek(*number);
    lower_to(*number, item.i, false);
  }
};

/// Lists items in the order in which they run.
struct ListItems {
  Index *count, *list;
  CDEM_HD void operator()(One item) const { list[raise(*count, false)] = item.i; }
};

/// Rows add up their own items; one row too far is a race.
struct SumRows {
  Index* sum;
  Index shift;
  Range items(Index row) const { return {3 * row, 3 * row + 3}; }
  bool selects(Index, Index) const { return true; }
  void operator()(const Selected& item) const { sum[item.row + (item.id % 3) * shift] += item.id; }
};

constexpr Index count = 100;

template <class T>
Column<T> column_of(std::size_t size) {
  Column<T> column;
  column.resize(size);
  return column;
}

/// Exit status of a process that does some work.
template <class Work>
int status_of(const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("items that read what others write are a race, those that keep to themselves are not") {
  Column<Real> x = column_of<Real>(count);
  CHECK_NOTHROW(for_each_item({}, count, Shift{x.data(), count, 0}));
  CHECK_THROWS_AS(for_each_item({}, count, Shift{x.data(), count, 1}), std::logic_error);
  CHECK_THROWS_AS(for_each_lane({}, count, Blocks{}, Shift{x.data(), count, 9}), std::logic_error);
  CHECK_NOTHROW(for_each_item({}, 1, Shift{x.data(), count, 1}));
}

TEST_CASE("a flag that several items set is no race if it is set as one, and not read") {
  Column<Flag> flag = column_of<Flag>(1);
  Column<Index> found = column_of<Index>(count);
  CHECK_THROWS_AS(for_each_item({}, count, WriteOne{flag.data()}), std::logic_error);
  CHECK_NOTHROW(for_each_item({}, count, SetOne{flag.data()}));
  CHECK_THROWS_AS(for_each_item({}, count, SetAndRead{flag.data(), found.data()}),
                  std::logic_error);
}

TEST_CASE("a number that items lower is no race if they look at it with care") {
  Column<Index> number = column_of<Index>(1), found = column_of<Index>(count);
  on_host(number)[0] = count;
  CHECK_NOTHROW(for_each_item({}, count, LookAndLower{number.data(), found.data(), false}));
  CHECK(on_host(number)[0] == 0);
  CHECK_THROWS_AS(for_each_item({}, count, LookAndLower{number.data(), found.data(), true}),
                  std::logic_error);
}

TEST_CASE("bytes of a word are told apart") {
  struct SetOwn {
    Flag* flags;
    CDEM_HD void operator()(One item) const { flags[item.i] = Flag(item.i); }
  };
  Column<Flag> flags = column_of<Flag>(count);
  CHECK_NOTHROW(for_each_item({}, count, SetOwn{flags.data()}));
}

TEST_CASE("the items of a row belong together") {
  Column<Index> sum = column_of<Index>(count + 2);
  CHECK_NOTHROW(for_each_selected({}, count, SumRows{sum.data(), 0}));
  CHECK_THROWS_AS(for_each_selected({}, count, SumRows{sum.data(), 1}), std::logic_error);
}

TEST_CASE("every launch has an order of its own") {
  Column<Index> number = column_of<Index>(1), list = column_of<Index>(count);
  std::vector<std::vector<Index>> orders;
  std::vector<Index> natural(count);
  std::iota(natural.begin(), natural.end(), 0);
  for (int launch = 0; launch < 2; ++launch) {
    on_host(number)[0] = 0;
    for_each_item({}, count, ListItems{number.data(), list.data()});
    orders.emplace_back(list.data(), list.data() + count);
    CHECK(orders.back() != natural);
    std::vector<Index> sorted = orders.back();
    std::sort(sorted.begin(), sorted.end());
    CHECK(sorted == natural);
  }
  CHECK(orders[0] != orders[1]);
}

TEST_CASE("launches run when host code waits for them, so it finds old numbers before") {
  Column<Real> x = column_of<Real>(count);
  const Real* now = x.data();
  queue_launches(true);
  for_each_item({}, count, Shift{x.data(), count, 0});
  CHECK(now[0] == 0);
  for_each_item({}, count, Shift{x.data(), count, 0});
  CHECK(on_host(x)[0] == 2);
  for_each_item({}, count, Shift{x.data(), count, 1});
  CHECK(now[0] == 2);
  CHECK_THROWS_AS(wait_for_launches(), std::logic_error);
  wait_for_launches();  // the fault has been told
  for_each_item({}, count, Shift{x.data(), count, 0});
  {
    const Column<Real> gone = std::move(x);
  }  // waits for launches that use it
  wait_for_launches();
  queue_launches(false);
}

TEST_CASE("kernels that touch memory of the host in a run are found") {
  std::vector<Real> x(count);
  CHECK_NOTHROW(for_each_item({}, count, Shift{x.data(), count, 0}));
  const RunOnDevice run;
  CHECK_THROWS_AS(for_each_item({}, count, Shift{x.data(), count, 0}), std::logic_error);
}

TEST_CASE("host code that touches arrays in a run is counted by page, outside of transfers") {
  constexpr std::size_t pages = 3, page = 4096 / sizeof(Real);
  Column<Real> x = column_of<Real>(pages * page);
  watch_host(HostWatch::count);
  const auto touch = [&] {
    const auto items = on_host(x);
    for (std::size_t k = 0; k < pages; ++k) items[k * page] = items[k * page + 1] + 1;
  };
  forget();
  touch();  // no run goes on
  {
    const RunOnDevice run;
    for_each_item({}, count, Shift{x.data(), count, 0});
    const Transfer transfer;
    touch();
    touch();  // waits for nothing any more
  }
  CHECK(seen().host.empty());
  CHECK(seen().launches == 1);
  CHECK(seen().waits == 1);
  CHECK(seen().transfers == 1);
  {
    const RunOnDevice run;
    touch();
    for_each_item({}, count, Shift{x.data(), count, 0});  // takes the arrays back
    touch();
  }
  std::int64_t reads = 0, writes = 0;
  for (const HostAccess& one : seen().host) reads += one.reads, writes += one.writes;
  watch_host(HostWatch::none);
  CHECK(reads == 2 * pages);
  CHECK(writes == 2 * pages);
}

TEST_CASE("strict, host code that touches an array in a run ends the program") {
  Column<Real> x = column_of<Real>(1);
  const auto touch = [&] {
    watch_host(HostWatch::strict);
    const RunOnDevice run;
    on_host(x)[0] = 1;
  };
  CHECK(status_of(touch) == 70);
  CHECK(status_of([&] {
          const Transfer transfer;
          touch();
        }) == 0);
}

}  // namespace cdem::test

#endif
