// States of laws from bond points to the walls of faces, against a loop over the pairs.
#include <cmath>

#include "core/bonds/transfer_to_contact.hpp"
#include "core/interfaces/history.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

constexpr Index width = HistoryRows::width, faces = 12, overlaps = 40;

/// Triangles and quadrilaterals, all exposed, in an order of its own, and overlaps between any of
/// them, so that a face is in several.
struct Walls {
  Model model;
  State state;
  Column<Index> listed;

  explicit Walls(Random& random) {
    std::vector<Index> place(faces), nodes(4 * faces), exposed(faces);
    for (Index f = 0; f < faces; ++f) place[f] = (5 * f + 3) % faces, exposed[place[f]] = f;
    for (Index f = 0; f < faces; ++f)
      for (Index k = 0; k < 4; ++k) nodes[4 * f + k] = k == 3 && f % 3 == 0 ? -1 : 4 * f + k;
    state.search.face_exposed.assign(place);
    state.search.exposed_face.assign(exposed);
    model.face_nodes.assign(nodes);
    model.interfaces.assign({{.law = 2}, {.law = 5}});
    add_overlaps(random);
    for (HistoryColumns* walls : {&state.springs.history, &state.edges.side_history}) {
      walls->width = width;
      walls->rows.resize(4 * faces * width);
      walls->law.resize(4 * faces, -1);
    }
    for (Real& number : on_host(state.springs.history.rows)) number = random.between(0, 1);
  }

 private:
  void add_overlaps(Random& random) {
    PairSet& p = model.overlaps;
    std::vector<Index> pairs, first{0}, interface, some;
    for (Index i = 0; i < overlaps; ++i) {
      const Index a = random.below(faces);
      pairs.push_back(a);
      pairs.push_back((a + 1 + random.below(faces - 1)) % faces);
      first.push_back(first.back() + 3 + random.below(4));
      interface.push_back(random.below(2));
      if (random.below(3) > 0) some.push_back(i);
    }
    const std::size_t points = first.back();
    std::vector<Real> weights[2], area(points), history;
    for (std::size_t c = 0; c < points; ++c) {
      area[c] = random.between(0.1, 1);
      for (auto& of : weights)
        for (Index k = 0; k < 4; ++k) of.push_back(random.below(3) > 0 ? random.between(-1, 1) : 0);
    }
    p.count = overlaps;
    p.points = 1;
    p.point_stride = Index(points);
    p.faces.assign(pairs);
    p.point_first.assign(first);
    p.interface.assign(interface);
    p.weights_a.assign(weights[0]);
    p.weights_b.assign(weights[1]);
    p.point_area.assign(area);
    for (std::size_t k = 0; k < width * points; ++k) history.push_back(random.between(0, 9));
    state.overlaps.history.assign(history);
    listed.assign(some);
  }
};

/// One pair gives to both of its faces.
void give_plainly(const PairSet& p, const std::vector<Real>& remembered, Walls& walls, Index i) {
  State& s = walls.state;
  const auto rows = on_host(s.springs.history.rows), edges = on_host(s.edges.side_history.rows);
  const auto law = on_host(s.springs.history.law), edge_law = on_host(s.edges.side_history.law);
  const Index own = on_host(walls.model.interfaces)[on_host(p.interface)[i]].law;
  for (const Index side : {0, 1}) {
    const Index face = on_host(p.faces)[2 * i + side];
    const Index slot = 4 * on_host(s.search.face_exposed)[face], count = face % 3 == 0 ? 3 : 4;
    const auto weights = on_host(side == 0 ? p.weights_a : p.weights_b);
    for (Index v = 0; v < count; ++v)
      for (Index k = 0; k < width; ++k) {
        Real sum = 0, total = 0;
        for (Index c = on_host(p.point_first)[i]; c < on_host(p.point_first)[i + 1]; ++c) {
          const Real weight = on_host(p.point_area)[c] * std::abs(weights[4 * c + v]);
          sum += weight * remembered[std::size_t(k) * p.point_stride + c], total += weight;
        }
        if (total > 0) rows[(slot + v) * width + k] = sum / total, law[slot + v] = own;
      }
    for (Index v = 0; v < count; ++v) {
      for (Index k = 0; k < width; ++k)
        edges[(slot + v) * width + k] =
            0.5 * (rows[(slot + v) * width + k] + rows[(slot + (v + 1) % count) * width + k]);
      edge_law[slot + v] = own;
    }
  }
}

}  // namespace

TEST_CASE("walls get the histories of their bond points, from the last pair where several meet") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Random random(seed), again(seed);
    Walls walls(random), expected(again);
    give_history(walls.model, walls.state, walls.model.overlaps, walls.state.overlaps,
                 walls.listed);
    const std::vector<Real> remembered = fetch(expected.state.overlaps.history);
    for (const Index i : fetch(expected.listed))
      give_plainly(expected.model.overlaps, remembered, expected, i);
    CHECK(fetch(walls.state.springs.history.rows) == fetch(expected.state.springs.history.rows));
    CHECK(fetch(walls.state.springs.history.law) == fetch(expected.state.springs.history.law));
    CHECK(fetch(walls.state.edges.side_history.rows) ==
          fetch(expected.state.edges.side_history.rows));
    CHECK(fetch(walls.state.edges.side_history.law) ==
          fetch(expected.state.edges.side_history.law));
  }
}

}  // namespace cdem::test
