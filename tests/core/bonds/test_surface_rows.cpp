// Edges that leave points, against sorted lists of them.
#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include "core/base/column.hpp"
#include "core/base/openmp.hpp"
#include "core/base/primitives.hpp"
#include "core/bonds/surface_rows.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Nodes with any edges, in points of a few nodes each.
struct Net {
  Index count;
  std::vector<Index> own_first, own, bonded_node;
  std::vector<Flag> exposed, wanted;

  Net(Random& random, Index nodes) : count(nodes), own_first{0}, exposed(nodes), wanted(nodes) {
    for (Index i = 0; i < count; ++i) {
      const Index other = std::max(i - 1 - random.below(40), Index(0));
      bonded_node.push_back(i == 0 || random.below(3) == 0 ? i : bonded_node[other]);
      for (Index k = random.below(6); k > 0; --k) own.push_back(random.below(count));
      own_first.push_back(Index(own.size()));
      exposed[i] = random.below(2);
    }
    for (Index i = 0; i < count; ++i) wanted[bonded_node[i]] |= exposed[i];
  }
  /// Ends of the edges of every label.
  std::vector<std::vector<Index>> stars() const {
    std::vector<std::map<Index, std::tuple<bool, Index>>> best(count);  // by label of the end
    for (Index i = 0; i < count; ++i)
      for (Index r = own_first[i]; r < own_first[i + 1]; ++r) {
        const std::tuple<bool, Index> end{!exposed[own[r]], own[r]};
        auto& known = best[bonded_node[i]].try_emplace(bonded_node[own[r]], end).first->second;
        known = std::min(known, end);
      }
    std::vector<std::vector<Index>> ends(count);
    for (Index label = 0; label < count; ++label)
      for (const auto& [of, end] : best[label])
        if (wanted[label]) ends[label].push_back(std::get<1>(end));
    return ends;
  }
};

template <class T>
Column<T> column_of(const std::vector<T>& items) {
  Column<T> column;
  column.assign(items);
  return column;
}

}  // namespace

TEST_CASE("a point has one end of a label: the lowest node at an exposed face, or the lowest") {
  Random random(8);
  const int threads_before = omp_get_max_threads();
  for (const Index count : {1, 2, 60, 3000})
    for (const int threads : {1, 3}) {
      omp_set_num_threads(threads);
      const Net net(random, count);
      const Column<Index> own_first = column_of(net.own_first), own = column_of(net.own);
      const Column<Index> bonded_node = column_of(net.bonded_node);
      const Column<Flag> exposed = column_of(net.exposed), wanted = column_of(net.wanted);
      Column<Index> first, edges, star_first, star;
      list_rows({}, count, Index(net.own.size()), count,
                EdgesOfPoints{.own_first = own_first.data(),
                              .own = own.data(),
                              .bonded_node = bonded_node.data(),
                              .exposed = exposed.data(),
                              .wanted = wanted.data()},
                first, edges);
      list_items({}, count,
                 EndsOfPoints{first.data(), edges.data(), own.data(), bonded_node.data()},
                 star_first, star);
      const std::vector<Index> starts = fetch(star_first), ends = fetch(star);
      const std::vector<std::vector<Index>> expected = net.stars();
      REQUIRE(Index(starts.size()) == count + 1);
      CHECK(starts[count] == Index(ends.size()));
      bool same = true;
      for (Index label = 0; label < count; ++label)
        same = same && std::vector<Index>(ends.begin() + starts[label],
                                          ends.begin() + starts[label + 1]) == expected[label];
      CHECK(same);
    }
  omp_set_num_threads(threads_before);
}

TEST_CASE("nodes of exposed faces and their points are flagged, the fourth of a triangle is none") {
  const Column<Index> faces = column_of<Index>({2, 0});
  const Column<Index> nodes = column_of<Index>({0, 1, 2, -1, 3, 4, 5, 6, 5, 7, 8, 9});
  const Column<Index> bonded_node = column_of<Index>({0, 0, 2, 3, 4, 4, 6, 2, 8, 9});
  Column<Flag> exposed, wanted;
  exposed.resize(10), wanted.resize(10);
  for_each_item({}, 2,
                MarkExposedPoints{.exposed_face = faces.data(),
                                  .face_nodes = nodes.data(),
                                  .bonded_node = bonded_node.data(),
                                  .exposed = exposed.data(),
                                  .wanted = wanted.data()});
  CHECK(fetch(exposed) == std::vector<Flag>{1, 1, 1, 0, 0, 1, 0, 1, 1, 1});
  CHECK(fetch(wanted) == std::vector<Flag>{1, 0, 1, 0, 1, 0, 0, 0, 1, 1});
}

}  // namespace cdem::test
