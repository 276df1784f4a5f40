// Labels of joined nodes against numbers that are spread until none changes, and of long chains.
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/column.hpp"
#include "core/base/openmp.hpp"
#include "core/base/parallel_loops.hpp"
#include "core/bonds/joined_nodes.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

using Bonds = std::vector<std::pair<Index, Index>>;

struct JoinEnds {
  const Index* ends;  // [bond][2]
  Labels labels;
  CDEM_HD void operator()(One bond) const { labels.join(ends[2 * bond.i], ends[2 * bond.i + 1]); }
};

/// Labels of nodes that begin with those of `start`, by a number of threads.
std::vector<Index> joined(const std::vector<Index>& start, const Bonds& bonds, int threads) {
  const int threads_before = omp_get_max_threads();
  omp_set_num_threads(threads);
  const Index count = Index(start.size());
  Column<Index> first, ends, label;
  first.assign(start);
  label.renew(count);
  ends.renew(2 * bonds.size());
  for (std::size_t i = 0; i < bonds.size(); ++i)
    on_host(ends)[2 * i] = bonds[i].first, on_host(ends)[2 * i + 1] = bonds[i].second;
  const Labels labels{label.data(), runs_alone()};
  for_each_item({}, count, StartLabels{first.data(), label.data()});
  for_each_item({}, Index(bonds.size()), JoinEnds{ends.data(), labels});
  for_each_item({}, count, FinishLabels{labels});
  std::vector<Index> found = fetch(label);
  omp_set_num_threads(threads_before);
  return found;
}

/// The same by spreading the lower label over every bond until all are alike.
std::vector<Index> spread(std::vector<Index> label, Bonds bonds) {
  for (Index i = 0; i < Index(label.size()); ++i) bonds.push_back({i, label[i]});
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : bonds)
      if (label[a] != label[b]) label[a] = label[b] = std::min(label[a], label[b]), changed = true;
  }
  return label;
}

std::vector<Index> own_numbers(Index count) {
  std::vector<Index> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

void shuffle(Random& random, auto& items) {
  for (Index i = Index(items.size()); i > 1; --i) std::swap(items[i - 1], items[random.below(i)]);
}

}  // namespace

TEST_CASE("nodes that any bonds join have the lowest of their numbers, on any number of threads") {
  Random random(3);
  for (const Index count : {1, 2, 50, 3000})
    for (const Real bonds_per_node : {0.0, 0.4, 0.6, 3.0}) {
      Bonds bonds(std::size_t(bonds_per_node * count));
      for (auto& [a, b] : bonds) a = random.below(count), b = random.below(count);
      const std::vector<Index> start = own_numbers(count), expected = spread(start, bonds);
      for (const int threads : {1, 3}) CHECK(joined(start, bonds, threads) == expected);
    }
}

TEST_CASE("no bond is lost where threads lower the label of one node at once") {
  Random random(6);
  constexpr Index count = 2000;
  const std::vector<Index> start = own_numbers(count), expected(count, 0);
  Bonds bonds;
  for (Index i = 0; i < count - 1; ++i) bonds.push_back({count - 1, i});
  bool whole = true;
  for (int round = 0; round < 500; ++round) {
    shuffle(random, bonds);
    whole = whole && joined(start, bonds, 3) == expected;
  }
  CHECK(whole);
}

TEST_CASE("nodes of a block are joined from the start") {
  Random random(4);
  constexpr Index count = 2400, a_block = 4;
  std::vector<Index> start = own_numbers(count);
  for (Index& first : start) first -= first % a_block;
  Bonds bonds(count / a_block);
  for (auto& [a, b] : bonds) a = random.below(count), b = random.below(count);
  for (const int threads : {1, 3}) CHECK(joined(start, bonds, threads) == spread(start, bonds));
}

TEST_CASE("a long chain has one label, in whatever order its nodes and its bonds are") {
  Random random(5);
  constexpr Index count = 1000;
  for (const bool along : {true, false}) {
    std::vector<Index> node = own_numbers(count);
    if (!along) shuffle(random, node);
    Bonds bonds;
    for (Index i = 1; i < count; ++i) bonds.push_back({node[i - 1], node[i]});
    const std::vector<Index> expected(count, 0);
    for (int order = 0; order < 3; ++order) {
      for (const int threads : {1, 3})
        CHECK(joined(own_numbers(count), bonds, threads) == expected);
      if (order == 0) std::reverse(bonds.begin(), bonds.end());
      if (order == 1) shuffle(random, bonds);
    }
    bonds.clear();
    for (Index i = 1; i < count; ++i)  // all but a bond in the middle
      if (i != count / 2) bonds.push_back({node[i - 1], node[i]});
    CHECK(joined(own_numbers(count), bonds, 3) == spread(own_numbers(count), bonds));
  }
}

TEST_CASE("looking for the lowest node shortens the way to it") {
  constexpr Index count = 1 << 10;
  Column<Index> label;
  label.resize(count);
  const auto way = on_host(label);
  for (Index i = 0; i < count; ++i) way[i] = std::max(i - 1, Index(0));
  const Labels labels{label.data(), true};
  const auto steps_from = [&](Index node) {
    Index steps = 0;
    for (; way[node] != node; node = way[node]) ++steps;
    return steps;
  };
  CHECK(steps_from(count - 1) == count - 1);
  CHECK(labels.lowest(count - 1) == 0);
  CHECK(steps_from(count - 1) <= count / 2 + 1);
}

}  // namespace cdem::test
