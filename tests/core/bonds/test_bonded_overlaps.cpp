// What bonds of overlapping faces keep from the search, against a list of all of it.
#include <set>
#include <utility>

#include "core/bonds/bonded_overlaps.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

constexpr Index face_count = 60, node_count = 80;

/// Overlaps of any faces, of which some are exposed, in any status.
struct Overlaps {
  Model model;
  State state;
  std::set<std::pair<Index, Index>> faces, vertices;

  Overlaps(Random& random, Index count) {
    std::vector<Index> nodes(4 * face_count), place(face_count), pairs(2 * count);
    for (Index& node : nodes) node = random.below(node_count + 1) - 1;
    for (Index f = 0, next = 0; f < face_count; ++f) place[f] = random.below(4) > 0 ? next++ : -1;
    for (Index& face : pairs) face = random.below(face_count);
    model.overlaps.count = count;
    model.overlaps.faces.assign(pairs);
    model.face_nodes.assign(nodes);
    state.search.face_exposed.assign(place);
    std::vector<Flag> status(count);
    for (Index i = 0; i < count; ++i) {
      status[i] = Flag(random.below(3));
      if (PairStatus(status[i]) != PairStatus::bonded) continue;
      for (const auto& [face, mate] :
           {std::pair(pairs[2 * i], pairs[2 * i + 1]), std::pair(pairs[2 * i + 1], pairs[2 * i])}) {
        faces.insert({place[face], place[mate]});
        for (Index k = 0; k < 4; ++k) vertices.insert({nodes[4 * face + k], place[mate]});
      }
    }
    state.overlaps.status.assign(status);
  }
};

}  // namespace

TEST_CASE("the faces and vertices of bonded overlaps are kept from the search, and no others") {
  Random random(17);
  for (const Index count : {0, 1, 2, 40, 200}) {
    const Overlaps all(random, count);
    const Bonded bonded = live_overlaps(all.model, all.state);
    const BondedView view = on_host(bonded.view());
    for (Index y = -1; y < face_count; ++y) {
      for (Index x = 0; x < face_count; ++x)
        CHECK(view.faces(x, y) == (all.faces.count({x, y}) > 0));
      for (Index node = 0; node < node_count; ++node)
        CHECK(view.vertices(node, y) == (all.vertices.count({node, y}) > 0));
    }
  }
}

}  // namespace cdem::test
