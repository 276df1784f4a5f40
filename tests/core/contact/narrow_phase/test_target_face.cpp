// Which face a semi-spring touches, Eq. 6-9.
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/target_face.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// A small tet above a large box, its tip down.
struct Tip : Scene {
  Index tip = 8;  // node, the first of the tet

  Tip() {
    add_box({-2, -2, -2}, {4, 4, 2});
    add<Tet4>({{{0, 0, 0}, {0.5, 0, 1}, {-0.3, 0.4, 1}, {-0.3, -0.4, 1}}});
    build();
    start();
  }
  /// Move the tet as a whole, with its tip at a place and a velocity.
  void put_tip(const Vec& at, const Vec& velocity = {0, 0, 0}) {
    const Vec shift = at - position(tip);
    for (Index i = tip; i < tip + 4; ++i) {
      put(motion(i), position(i) + shift);
      put(motion(i) + 4, velocity);
    }
    state.dt_last = 1e-3;
    update_all_face_geometry(model, state, {});
  }
  /// Targets that the tip finds through the faces of the tet that it is a corner of.
  std::vector<Index> targets() {
    const ResolveTargets search{face_search(model, state)};
    std::vector<Index> found;
    lost = 0;
    for (Index x = 6; x < Index(state.search.exposed_face.size()); ++x)
      for (Index k = 0; k < 3; ++k)
        if (on_host(state.search.exposed)[x].corner[k] == tip)
          found.push_back(
              search.choose(x, k, {faces().data(), nullptr, Index(faces().size())}, &lost));
    return found;
  }
  std::vector<Index> faces() const { return {0, 1, 2, 3, 4, 5}; }
  Flag lost = 0;
};

constexpr Index top = 1;  // face of the box
const std::vector<Index> none{-1, -1, -1};

}  // namespace

TEST_CASE("a vertex touches the face that it is behind, with all its faces") {
  Tip tip;
  tip.put_tip({0.3, 0.2, -0.001});
  CHECK(tip.targets() == std::vector<Index>{top, top, top});
  tip.put_tip({0.3, 0.2, 0.001});
  CHECK(tip.targets() == none);
}

TEST_CASE("a contact may begin as deep as the entry, and 1.5 times the approach of the step") {
  Tip tip;
  const Real length =
      std::min(on_host(tip.model.face_length)[6], on_host(tip.model.face_length)[top]);
  const Real entry = tip.model.rules.entry * length;
  // at an edge of the top, where the way out is shorter through the side
  const Real x = 2 - 0.5 * entry;
  tip.put_tip({x, 0, -0.99 * entry});
  CHECK(tip.targets()[0] == top);
  tip.put_tip({x, 0, -1.2 * entry});
  CHECK(tip.targets()[0] != top);
  tip.put_tip({x, 0, -1.2 * entry}, {0, 0, -0.2 * entry / (1.4 * 1e-3)});
  CHECK(tip.targets()[0] == top);
}

TEST_CASE("a vertex outside the face does not touch it, whatever its depth") {
  Tip tip;
  tip.put_tip({2.5, 0, -0.01});
  CHECK(tip.targets() == none);
  tip.put_tip({0, 2.1, -0.01});
  CHECK(tip.targets() == none);
}

TEST_CASE("a vertex that an edge of its own goes below is not in contact") {
  Tip tip;
  // turned over: the other corners are below the tip
  for (Index i = tip.tip; i < tip.tip + 4; ++i) {
    const Vec x = tip.position(i);
    put(tip.motion(i), Vec{x.x, -x.y, -x.z});
  }
  tip.put_tip({0, 0, -0.001});
  CHECK(tip.targets() == none);
}

TEST_CASE("a face that does not oppose the mother face is no target") {
  Tip tip;
  tip.put_tip({0.3, 0.2, -0.001});
  const ResolveTargets search{face_search(tip.model, tip.state)};
  for (Index x = 6; x < 10; ++x)
    for (Index k = 0; k < 3; ++k) {
      if (on_host(tip.state.search.exposed)[x].corner[k] != tip.tip) continue;
      for (const Index t : tip.faces()) {
        Flag lost = 0;
        if (search.choose(x, k, {&t, nullptr, 1}, &lost) >= 0) CHECK(t == top);
      }
    }
}

TEST_CASE("a contact in place is kept deeper than one may begin, and lost under load below that") {
  Tip tip;
  const Real length =
      std::min(on_host(tip.model.face_length)[6], on_host(tip.model.face_length)[top]);
  SpringColumns springs = spring_columns(tip.state);
  for (Index x = 6; x < 10; ++x)
    for (Index k = 0; k < 3; ++k) {
      springs.target[4 * x + k] = springs.target_before[4 * x + k] = top;
      ContactState{.force_n = 1,
                   .penetration = 0.1,
                   .shear1 = 0,
                   .shear2 = 0,
                   .stress_free_gap = 0,
                   .energy_n = 0,
                   .energy_s = 0}
          .store(springs.state, 4 * x + k);
    }
  tip.put_tip({0.3, 0.2, -0.9 * tip.model.rules.depth * length});
  CHECK(tip.targets() == std::vector<Index>{top, top, top});
  CHECK(tip.lost == 0);
  tip.put_tip({0.3, 0.2, -1.1 * tip.model.rules.depth * length});
  tip.targets();
  CHECK(tip.lost == 1);
}

TEST_CASE("contacts are kept and sifted in lanes as they are chosen one by one") {
  Random random(1);
  Tip tip;
  for (int round = 0; round < 50; ++round) {
    tip.put_tip({random.between(-2.2, 2.2), random.between(-2.2, 2.2), random.between(-0.03, 0.01)},
                random.vector(3));
    const Index exposed = Index(tip.state.search.exposed_face.size());
    tip.state.springs.unresolved.resize(4 * exposed);
    FaceSearch search = face_search(tip.model, tip.state);
    for_each_item({}, exposed, BeginTargets{search.springs});
    const std::vector<Index> expected = tip.targets();
    // the whole stage, all faces of the box being candidates of every slot of the tet
    std::vector<Index> first(4 * exposed + 1), other;
    for (Index slot = 0; slot < 4 * exposed; ++slot) {
      const bool of_tip = slot % 4 < 3 && slot >= 24 &&
                          on_host(tip.state.search.exposed)[slot / 4].corner[slot % 4] == tip.tip;
      if (of_tip) other.insert(other.end(), {0, 1, 2, 3, 4, 5});
      first[slot + 1] = Index(other.size());
    }
    Column<Index> firsts, others;
    Column<Flag> rises, may_begin;
    firsts.assign(first);
    others.assign(other);
    rises.resize(other.size());
    may_begin.resize(other.size());
    search.candidates = {firsts.data(), others.data(), rises.data(), may_begin.data()};
    for_each_selected({}, exposed, UpdateHeldTargets{search});
    for_each_selected({}, exposed, FilterNewTargets{search});
    for_each_item({}, exposed, ResolveTargets{search});
    std::vector<Index> found;
    for (Index slot = 24; slot < 4 * exposed; ++slot)
      if (first[slot + 1] > first[slot]) found.push_back(on_host(tip.state.springs.target)[slot]);
    CHECK(found == expected);
  }
}

}  // namespace cdem::test
