// Views read and write what lies at an item's place, for one item as for a lane.
#include <vector>

#include "core/base/column.hpp"
#include "core/base/views.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

constexpr Index rows = 4 * lanes;

std::vector<Real> numbers(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Real> list(count);
  for (Real& x : list) x = random.between(-1, 1);
  return list;
}

/// Any places of a list, different ones or not.
IndexPack places(Random& random, bool different) {
  IndexPack at;
  for (Index j = 0; j < lanes; ++j) at.id[j] = different ? (3 * j + 2) % rows : random.below(rows);
  return at;
}

}  // namespace

TEST_CASE("a table has one row a quantity, for one item and for a lane") {
  const Index stride = padded_stride(rows);
  std::vector<Real> data = numbers(3 * stride, 1);
  const InTable in{data.data(), stride};
  const InOutTable inout{data.data(), stride};
  for (Index row = 0; row < 3; ++row) {
    CHECK(in.at(row, One{5}) == data[row * stride + 5]);
    const Pack p = in.at(row, Lane{3}), q = inout.at(row, Lane{3});
    for (Index j = 0; j < lanes; ++j) {
      CHECK(p.n[j] == data[row * stride + 3 + j]);
      CHECK(q.n[j] == p.n[j]);
    }
  }
  const std::vector<Real> before = data;
  inout.set(1, Lane{2}, Pack(7.0));
  inout.set(2, One{0}, 8.0);
  for (std::size_t k = 0; k < data.size(); ++k) {
    const bool in_lane = k >= std::size_t(stride + 2) && k < std::size_t(stride + 2 + lanes);
    CHECK(data[k] == (in_lane ? 7 : k == std::size_t(2 * stride) ? 8 : before[k]));
  }
}

TEST_CASE("a table of indices has one row a corner") {
  std::vector<Index> data(2 * rows);
  for (Index i = 0; i < 2 * rows; ++i) data[i] = i * i;
  const InIndices in{data.data(), rows};
  const IndexPack p = in.at(1, Lane{lanes});
  for (Index j = 0; j < lanes; ++j) {
    CHECK(p.id[j] == data[rows + lanes + j]);
    CHECK(in.at(1, One{lanes + j}) == p.id[j]);
  }
}

TEST_CASE("rows of four are read into packs and written back, wherever they lie") {
  Random random(2);
  const std::vector<Real> data = numbers(4 * rows, 3);
  for (int round = 0; round < 20; ++round) {
    IndexPack at = places(random, false);
    for (Index& place : at.id) place *= 4;
    const Four<Pack> v = fours_at(data.data(), at);
    for (Index j = 0; j < lanes; ++j) {
      const Four<Real> one = fours_at(data.data(), at.id[j]);
      CHECK(v.x.n[j] == data[at.id[j]]);
      CHECK(v.x.n[j] == one.x);
      CHECK(v.y.n[j] == one.y);
      CHECK(v.z.n[j] == one.z);
      CHECK(v.w.n[j] == one.w);
      CHECK(one.w == data[at.id[j] + 3]);
    }
  }
  std::vector<Real> copy(data.size());
  for (Index i = 0; i < rows; i += lanes) {
    IndexPack at;
    for (Index j = 0; j < lanes; ++j) at.id[j] = 4 * (i + j);
    set_fours(copy.data(), at, fours_at(data.data(), at));
  }
  CHECK(copy == data);
  std::vector<Real> one_by_one(data.size());
  for (Index i = 0; i < rows; ++i)
    set_fours(one_by_one.data(), 4 * i, fours_at(data.data(), 4 * i));
  CHECK(one_by_one == data);
}

TEST_CASE("set_rows writes 8 numbers for every item and nothing else") {
  Random random(4);
  const IndexPack at = places(random, true);
  Pack eight[8];
  for (Index k = 0; k < 8; ++k) eight[k] = pack_of([&](Index j) { return 100.0 * j + k; });
  std::vector<Real> in_lanes(8 * rows, -1), one_by_one(8 * rows, -1);
  set_rows(in_lanes.data(), at, eight);
  for (Index j = 0; j < lanes; ++j) {
    Real row[8];
    for (Index k = 0; k < 8; ++k) row[k] = eight[k].n[j];
    set_rows(one_by_one.data(), One{at.id[j]}, row);
    CHECK(one_by_one[8 * at.id[j] + 5] == 100 * j + 5);
  }
  CHECK(in_lanes == one_by_one);
  CHECK(std::count(in_lanes.begin(), in_lanes.end(), -1) == 8 * (rows - lanes));

  std::vector<Real> consecutive(8 * rows, -1);
  set_rows(consecutive.data(), Lane{lanes}, eight);
  for (Index j = 0; j < lanes; ++j)
    for (Index k = 0; k < 8; ++k) CHECK(consecutive[8 * (lanes + j) + k] == 100 * j + k);
  CHECK(std::count(consecutive.begin(), consecutive.end(), -1) == 8 * (rows - lanes));
}

TEST_CASE("rows of 8 are read from either half") {
  const std::vector<Real> data = numbers(8 * rows, 5);
  const InRows in{data.data()};
  Random random(6);
  const IndexPack at = places(random, false);
  for (const Index from : {0, 4}) {
    const Four<Pack> v = in.at(at, from), next = in.at(Lane{2}, from);
    for (Index j = 0; j < lanes; ++j) {
      CHECK(v.w.n[j] == data[8 * at.id[j] + from + 3]);
      CHECK(in.at(at.id[j], from).y == v.y.n[j]);
      CHECK(in.at(One{2 + j}, from).x == next.x.n[j]);
    }
  }
}

TEST_CASE("motion of nodes: position, then velocity") {
  const std::vector<Real> data = numbers(8 * rows, 7);
  const InMotion nodes{data.data()};
  Random random(8);
  const IndexPack at = places(random, false);
  const Vec3<Pack> x = nodes.position(at), v = nodes.velocity(at);
  for (Index j = 0; j < lanes; ++j) {
    const Index i = at.id[j];
    CHECK(distance(nodes.position(i), vector_at(data.data() + 8 * i)) == 0);
    CHECK(distance(nodes.velocity(i), vector_at(data.data() + 8 * i + 4)) == 0);
    CHECK(distance(nodes.position(i), Vec{x.x.n[j], x.y.n[j], x.z.n[j]}) == 0);
    CHECK(distance(nodes.velocity(i), Vec{v.x.n[j], v.y.n[j], v.z.n[j]}) == 0);
  }
}

TEST_CASE("forces on corners: written for an item, read with either sign") {
  constexpr Index corners = 3;
  Vec3<Pack> force;
  force.x = pack_of([](Index j) { return 1.0 + j; });
  force.y = pack_of([](Index j) { return 20.0 + j; });
  force.z = pack_of([](Index j) { return 300.0 + j; });
  std::vector<Real> in_lanes(4 * corners * rows), one_by_one(4 * corners * rows);
  OutForces{in_lanes.data()}.set(Lane{lanes}, corners, 2, force);
  for (Index j = 0; j < lanes; ++j)
    OutForces{one_by_one.data()}.set(One{lanes + j}, corners, 2, Vec{1.0 + j, 20.0 + j, 300.0 + j});
  CHECK(in_lanes == one_by_one);

  const InForces in{in_lanes.data()};
  IndexPack row;
  for (Index j = 0; j < lanes; ++j) {
    const Index at = (lanes + j) * corners + 2;
    row.id[j] = j % 2 ? ~at : at;
    const Real sign = j % 2 ? -1 : 1;
    CHECK(distance(in.signed_at(row.id[j]),
                   Vec{sign * (1 + j), sign * (20 + j), sign * (300 + j)}) == 0);
    CHECK(distance(in.at(at).vector(), in.signed_at(at)) == 0);
  }
  const Vec3<Pack> read = in.signed_at(row);
  for (Index j = 0; j < lanes; ++j)
    CHECK(distance(in.signed_at(row.id[j]), Vec{read.x.n[j], read.y.n[j], read.z.n[j]}) == 0);
  // the row that adds nothing keeps the sign of a zero, whichever way it is meant
  const Real nothing[4] = {-0.0, -0.0, -0.0, -0.0};
  CHECK(same_bits(InForces{nothing}.signed_at(0).x, -0.0));
}

TEST_CASE("numbers, indices and flags of a list") {
  std::vector<Real> list = numbers(rows, 9);
  std::vector<Index> ids(rows);
  std::vector<Flag> flags(rows, 5);
  for (Index i = 0; i < rows; ++i) ids[i] = rows - i;
  Random random(10);
  const IndexPack at = places(random, true);
  const Pack found = look_up(list.data(), at);
  const IndexPack found_ids = look_up(ids.data(), at);
  for (Index j = 0; j < lanes; ++j) {
    CHECK(found.n[j] == look_up(list.data(), at.id[j]));
    CHECK(found_ids.id[j] == look_up(ids.data(), at.id[j]));
    CHECK(found_ids.id[j] == rows - at.id[j]);
  }
  const std::vector<Real> before = list;
  add_to(list.data(), at, Pack(1.0));
  add_to(list.data(), 0, 2.0);
  for (Index i = 1; i < rows; ++i) {
    const bool here = std::find(at.id, at.id + lanes, i) != at.id + lanes;
    CHECK(list[i] == before[i] + (here ? 1 : 0));
  }
  store(list.data(), Lane{1}, Pack(4.0));
  store(list.data(), One{0}, 3.0);
  CHECK(list[0] == 3);
  for (Index j = 0; j < lanes; ++j) CHECK(list[1 + j] == 4);
  set_flags(flags.data(), Lane{1}, Pack(1.0) > Pack(0.0));
  set_flags(flags.data(), One{0}, false);
  CHECK(flags[0] == 0);
  for (Index j = 0; j < lanes; ++j) CHECK(flags[1 + j] == 1);
  CHECK(flags[1 + lanes] == 5);
}

}  // namespace cdem::test
