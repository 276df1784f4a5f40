// A tree of boxes finds those that overlap, all of them and each once.
#include <limits>

#include "core/contact/broad_phase/bounding_boxes.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

Box random_box(Random& random, Real spread, Real size) {
  Box box = Box::nothing();
  const Vec at = random.vector(spread);
  box.include(at);
  box.include(at + random.vector(size));
  return box;
}

/// A tree of boxes of the host.
struct Tree {
  Column<Box> boxes;
  BoxTreeColumns columns;
  BoxTree tree;

  explicit Tree(const std::vector<Box>& list) {
    boxes.assign(list);
    columns.make({}, boxes);
    tree = on_host(columns.tree());
  }
};

std::vector<Index> found(const Tree& of, const Box& box) {
  std::vector<Index> list;
  of.tree.query(box, [&](Index i) { list.push_back(i); });
  std::sort(list.begin(), list.end());
  return list;
}

std::vector<Index> overlapping(const std::vector<Box>& boxes, const Box& box) {
  std::vector<Index> list;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].overlaps(box)) list.push_back(Index(i));
  return list;
}

}  // namespace

TEST_CASE("a box holds what it has included, and is as small as can be") {
  Box box = Box::nothing();
  box.include(Vec{1, 2, 3});
  box.include(Vec{-1, 5, 0});
  Box other = Box::nothing();
  other.include(Vec{0, 0, 4});
  box.include(other);
  const Real low[] = {-1, 0, 0}, high[] = {1, 5, 4};
  for (int d = 0; d < 3; ++d) {
    CHECK(box.low[d] == low[d]);
    CHECK(box.high[d] == high[d]);
  }
  box.inflate(0.5);
  CHECK(box.low[1] == -0.5);
  CHECK(box.high[2] == 4.5);
}

TEST_CASE("boxes overlap unless an axis separates them; those that touch do overlap") {
  const Box a{{0, 0, 0}, {1, 1, 1}};
  CHECK(a.overlaps(a));
  CHECK(a.overlaps({{0.2, 0.2, 0.2}, {0.3, 0.3, 0.3}}));
  CHECK(a.overlaps({{1, 1, 1}, {2, 2, 2}}));
  for (int d = 0; d < 3; ++d) {
    Box above = a, below = a;
    above.low[d] = 1.1, above.high[d] = 2;
    below.low[d] = -2, below.high[d] = -0.1;
    CHECK(!a.overlaps(above));
    CHECK(!a.overlaps(below));
    CHECK(!below.overlaps(a));
  }
  CHECK(!a.overlaps(Box::nothing()));
}

TEST_CASE("the Morton code interleaves the bits of three numbers") {
  CHECK(morton_code(1, 0, 0) == 1);
  CHECK(morton_code(0, 1, 0) == 2);
  CHECK(morton_code(0, 0, 1) == 4);
  for (int bit = 0; bit < 21; ++bit) {
    CHECK(morton_code(1ull << bit, 0, 0) == 1ull << (3 * bit));
    CHECK(morton_code(0, 1ull << bit, 1ull << bit) == 6ull << (3 * bit));
  }
  CHECK(morton_code(0x1fffff, 0x1fffff, 0x1fffff) == 0x7fffffffffffffffull);
}

TEST_CASE("a query finds the boxes that overlap, whatever their number and sizes") {
  Random random(1);
  std::size_t hits = 0;
  for (const Index count : {0, 1, 7, 8, 9, 64, 65, 600}) {
    std::vector<Box> boxes;
    for (Index i = 0; i < count; ++i)
      boxes.push_back(random_box(random, 5, i % 50 == 0 ? 20 : random.between(0.01, 3)));
    const Tree tree(boxes);
    for (int k = 0; k < 50; ++k) {
      const Box box = random_box(random, 5, random.between(0, 8));
      CHECK(found(tree, box) == overlapping(boxes, box));
      hits += found(tree, box).size();
    }
  }
  CHECK(hits > 500);
}

TEST_CASE("boxes at one place, or on a line, are found") {
  std::vector<Box> same(100, Box{{1, 1, 1}, {2, 2, 2}}), line;
  for (Index i = 0; i < 100; ++i) line.push_back({{Real(i), 0, 0}, {i + 0.5, 0, 0}});
  CHECK(found(Tree(same), {{2, 2, 2}, {3, 3, 3}}).size() == 100);
  CHECK(found(Tree(line), {{10.2, 0, 0}, {13, 0, 0}}) == std::vector<Index>{10, 11, 12, 13});
}

TEST_CASE("a box that is no number any more overlaps everything") {
  const std::vector<Box> boxes(20, Box{{0, 0, 0}, {1, 1, 1}});
  const Tree tree(boxes);
  const Real none = std::numeric_limits<Real>::quiet_NaN();
  CHECK(found(tree, {{none, none, none}, {none, none, none}}).size() == 20);
}

}  // namespace cdem::test
