// Overlaps at the start that no contact can hold are found, with their depth and place.
#include <vector>

#include "core/contact/pair_list/deep_overlaps.hpp"
#include "tests/core/elements/reference.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// What is found in a scene once contacts hold what they can.
DeepOverlaps found_in(Scene& scene) {
  scene.build();
  scene.start();
  InitialOverlaps adopted = adopt_overlaps(scene.model, scene.state);
  return find_deep_overlaps(scene.model, scene.state, adopted);
}

}  // namespace

TEST_CASE("a box that contacts hold is no deep overlap, one below their limit is") {
  for (const Real depth : {-0.1, 0.0, 0.01, 0.2, 0.3, 0.4, 0.9}) {
    Scene scene;
    scene.add_box({-1, -1, -1}, {3, 3, 1}, true);
    scene.add_box({0, 0, -depth}, {1, 1, 1});
    const DeepOverlaps found = found_in(scene);
    CHECK(found.count == (depth > 0.3 * std::sqrt(0.5)));
    if (!found.count) continue;
    CHECK(relative_error(found.depth, depth) < 1e-12);
    CHECK(relative_error(found.allowed, 0.05 * std::sqrt(0.5)) < 1e-12);
    CHECK(distance(found.place, {0.5, 0.5, -0.5 * depth}) < 1e-12);
    CHECK(found.block[0] + found.block[1] == 1);
  }
}

TEST_CASE("the depth of two tets is the least translation that takes them apart") {
  Random random(5);
  int overlapping = 0;
  for (int n = 0; n < 200; ++n) {
    const Vec shift = random.vector(0.7);
    const Mat turn = random.rotation();
    const auto corners = [&](bool turned, const Vec& by) {
      std::array<Vec, 4> x;
      for (int k = 0; k < 4; ++k) {
        const Vec p{Real(k == 1), Real(k == 2), Real(k == 3)};
        x[k] = by + (turned ? turn * p : p);
      }
      return x;
    };
    Scene scene;
    scene.add<Tet4>(corners(false, {0, 0, 0}));
    scene.add<Tet4>(corners(true, shift));
    const DeepOverlaps found = found_in(scene);
    if (!found.count) continue;
    ++overlapping;
    // moved by less in any direction they still overlap: the depth is a lower bound in all
    for (int k = 0; k < 20; ++k) {
      Scene moved;
      moved.add<Tet4>(corners(false, {0, 0, 0}));
      moved.add<Tet4>(corners(true, shift + 0.7 * found.depth * random.direction()));
      moved.model.rules.entry = 0.01;
      moved.model.rules.depth = 0;
      CHECK(found_in(moved).count == 1);
    }
  }
  CHECK(overlapping > 20);
}

TEST_CASE("a vertex deep beside a rim is adopted although an edge from it reaches deeper") {
  Scene scene;
  scene.add_box({-3, -3, -2}, {6, 6, 2}, true);
  scene.add<Tet4>({Vec{2.5, 0, -0.2}, Vec{4, 0, -0.8}, Vec{3.3, 1, 0.6}, Vec{3.3, -1, 0.6}});
  scene.build();
  scene.start();
  InitialOverlaps adopted = adopt_overlaps(scene.model, scene.state);
  CHECK(adopted.count == 0);
  CHECK(find_deep_overlaps(scene.model, scene.state, adopted).count == 0);
  CHECK(adopted.count > 0);
  CHECK(relative_error(adopted.deepest, 0.2) < 1e-14);
}

TEST_CASE_TEMPLATE("a small tet inside an element of any shape is found, one outside is not", Shape,
                   Tet4, Pyramid5, Wedge6, Hex8) {
  const auto corners = Reference<Shape>::corners();
  Vec middle{0, 0, 0};
  for (const Vec& x : corners) middle = middle + Real(1.0 / corners.size()) * x;
  Random random(9);
  int inside = 0, outside = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec place = middle + random.vector(n % 2 ? 1.2 : 0.25);
    // is it inside? Where all corners but those in one plane lie on one side, that plane is a face
    bool in = true, near = false;
    for (std::size_t a = 0; a < corners.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        for (std::size_t c = 0; c < b; ++c) {
          const Vec across = cross(corners[b] - corners[a], corners[c] - corners[a]);
          if (norm(across) < 1e-9) continue;
          Vec out = unit(across);
          if (dot(out, corners[a] - middle) < 0) out = Real(-1) * out;
          bool face = true;
          for (const Vec& x : corners) face = face && dot(out, x - corners[a]) < 1e-9;
          if (!face) continue;
          in = in && dot(out, place - corners[a]) < 0;
          near = near || std::abs(dot(out, place - corners[a])) < 0.05;
        }
    if (near) continue;  // partly in, or in contact
    Scene scene;
    scene.add<Shape>(corners);
    scene.add_tet(random, place, 0.02);
    CHECK((found_in(scene).count == 1) == in);
    (in ? inside : outside) += 1;
  }
  CHECK(inside > 5);
  CHECK(outside > 30);
}

TEST_CASE("two blocks that cannot move do not count") {
  Scene scene;
  scene.add_box({0, 0, 0}, {1, 1, 1}, true);
  scene.add_box({0.5, 0, 0}, {1, 1, 1}, true);
  CHECK(found_in(scene).count == 0);
}

TEST_CASE("the same body twice overlaps by its smallest height") {
  for (const Real height : {0.5, 1.0}) {
    Scene scene;
    scene.add_box({0, 0, 0}, {1, 1, height});
    scene.add_box({0, 0, 0}, {1, 1, height});
    CHECK(relative_error(found_in(scene).depth, height) < 1e-12);
  }
}

}  // namespace cdem::test
