// Packs compute what numbers do, lane by lane.
#include <limits>

#include "core/base/lanes.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// Numbers of all sizes, and zeros of both signs.
Real any_number(Random& random) {
  if (random.below(5) == 0) return random.below(2) ? 0.0 : -0.0;
  return random.between(-1, 1) * std::pow(10.0, random.between(-100, 100));
}

/// Or what is no number, or infinite.
Real anything(Random& random) {
  using Limits = std::numeric_limits<Real>;
  if (random.below(4) > 0) return any_number(random);
  const Real odd[] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()};
  return odd[random.below(3)];
}

Pack pack(const Real* numbers) {
  return pack_of([&](Index j) { return numbers[j]; });
}

}  // namespace

TEST_CASE("arithmetic of a pack is that of its numbers, bit by bit") {
  Random random(1);
  check_lanes<2, 6>(
      [](const auto* in, auto* out) {
        const auto a = in[0], b = in[1];
        out[0] = a + b;
        out[1] = a - b;
        out[2] = a * b;
        out[3] = -a;
        out[4] = a;
        out[4] += b;
        out[5] = a;
        out[5] -= b;
      },
      [&](Real* in) { in[0] = any_number(random), in[1] = any_number(random); });
  check_lanes<2, 2>(
      [](const auto* in, auto* out) {
        out[0] = in[0] / in[1];
        out[1] = sqrt_of(in[1]);
      },
      [&](Real* in) { in[0] = any_number(random), in[1] = random.between(1e-3, 1e3); });
}

TEST_CASE("a pack chooses as its numbers do, whatever they are") {
  Random random(2);
  check_lanes<2, 6>(
      [](const auto* in, auto* out) {
        const auto a = in[0], b = in[1];
        out[0] = max_of(a, b);
        out[1] = min_of(a, b);
        out[2] = abs_of(a);
        out[3] = select(a < b, a, b);
        out[4] = select((a > b) | !(a < b), a, b);
        out[5] = select((a > b) & !(a < b), a, b);
      },
      [&](Real* in) { in[0] = anything(random), in[1] = anything(random); });
}

TEST_CASE("comparisons with what is no number are false in every lane") {
  const Pack none(std::numeric_limits<Real>::quiet_NaN()), one(1.0);
  CHECK(lane_bits(none < one) == 0);
  CHECK(lane_bits(none > one) == 0);
  CHECK(lane_bits(!(none > one)) == (1u << lanes) - 1);
}

TEST_CASE("lane_bits, any_of and holds tell the same of a mask") {
  for (unsigned bits = 0; bits < 1u << lanes; ++bits) {
    const Pack numbers = pack_of([&](Index j) { return bits >> j & 1 ? 2.0 : 0.0; });
    const Mask mask = numbers > Pack(1.0);
    CHECK(lane_bits(mask) == bits);
    CHECK(any_of(mask) == (bits != 0));
    for (Index j = 0; j < lanes; ++j) CHECK(holds(mask, j) == (bits >> j & 1));
  }
  CHECK(lane_bits(true) == 1);
  CHECK(lane_bits(false) == 0);
}

TEST_CASE("a pack takes every lane from where it belongs") {
  Real numbers[lanes];
  for (Index j = 0; j < lanes; ++j) numbers[j] = 10 + j;
  const Pack p = pack(numbers);
  for (Index j = 0; j < lanes; ++j) CHECK(p.n[j] == 10 + j);
}

TEST_CASE("indices and numbers are made lane by lane") {
  IndexPack a, b;
  for (Index j = 0; j < lanes; ++j) a.id[j] = 3 * j, b.id[j] = j % 2;
  const auto sum = [](Index x, Index y) { return 100 * x + y; };
  const IndexPack indices = indices_of(sum, a, b);
  const Pack numbers = numbers_of(sum, a, b);
  const Mask unlike = differ(a, b);
  for (Index j = 0; j < lanes; ++j) {
    CHECK(of_lane(indices, j) == indices_of(sum, a.id[j], b.id[j]));
    CHECK(numbers.n[j] == numbers_of(sum, a.id[j], b.id[j]));
    CHECK(holds(unlike, j) == differ(a.id[j], b.id[j]));
  }
  const IndexPack of_items = indices_of([](Index i) { return 2 * i; }, Lane{5});
  for (Index j = 0; j < lanes; ++j) CHECK(of_items.id[j] == 2 * (5 + j));
}

TEST_CASE("for_lanes visits every lane of an item once, with its row and number") {
  SelectedLane item;
  for (Index j = 0; j < lanes; ++j) item.row.id[j] = 7 * j, item.id.id[j] = 9 * j;
  Index next = 0;
  for_lanes(item, [&](Index lane, Index row, Index id) {
    CHECK(lane == next);
    CHECK(row == 7 * next);
    CHECK(id == 9 * next++);
  });
  CHECK(next == lanes);
  next = 0;
  for_lanes(Lane{4}, [&](Index lane, Index id) {
    CHECK(lane == next);
    CHECK(id == 4 + next++);
  });
  CHECK(next == lanes);
  for_lanes(Selected{2, 3}, [&](Index lane, Index row, Index id) {
    CHECK(lane == 0);
    CHECK(row == 2);
    CHECK(id == 3);
  });
  for_lanes(One{6}, [&](Index lane, Index id) {
    CHECK(lane == 0);
    CHECK(id == 6);
  });
}

}  // namespace cdem::test
