// Forces that modules apply from outside, from their rows to the sums on nodes.
#include "core/model/applied_lists.hpp"
#include "core/nodes/applied.hpp"
#include "core/nodes/curves.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two boxes; 1 kPa of water presses on the top of the first, given by its nodes.
struct Wet : Scene {
  std::vector<Index> top;

  Wet() {
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({5, 0, 0}, {1, 1, 1});
    build();
    find_loads_and_supports(model, state);
    const auto nodes = on_host(model.face_nodes);
    Index face = 0;
    while (!is_top(nodes.data() + 4 * face)) ++face;
    top.assign(nodes.begin() + 4 * face, nodes.begin() + 4 * face + 4);
    WaterSet& w = given_of<Water>(model);
    Water::take_counts(
        w, [](const char* name) { return std::string(name) == "wet_quads.count" ? 1 : 0; });
    for (const Real p : {1000.0, 0.0}) {  // the last field is dry
      push(w.fields, p);
      for (int k = 1; k < 8; ++k) push(w.fields, 0);
      for (int k = 0; k < 2; ++k) push(w.field_curve, 0);
    }
    w.quads.nodes.resize(4 * w.quads.stride);
    w.quads.kept.resize(4 * w.quads.stride);
    for (std::size_t k = 0; k < 4; ++k) on_host(w.quads.nodes)[k * w.quads.stride] = top[k];
    push(w.quads.face, face);
    push(w.quads.joint, 1);
    push(w.quads.open, 0);
    push(w.quads.bonded, 0);
    push(w.quads.aperture, 0);
    w.quads.pair_first.resize(2);
    w.triangles.pair_first.resize(1);
    list_applied(model, state);
  }
  bool is_top(const Index* nodes) const {
    for (Index k = 0; k < 4; ++k)
      if (position(nodes[k]).z != 1) return false;
    return true;
  }
  bool is_wet(Index node) const { return std::find(top.begin(), top.end(), node) != top.end(); }
};

}  // namespace

TEST_CASE("nodes sum the rows that modules apply to them, and no other node is loaded") {
  Wet wet;
  const std::vector<Real> change = change_applied(wet.model, wet.state);
  const auto has = on_host(wet.state.nodes.has_applied);
  REQUIRE(change.size() == 4 * std::size_t(wet.model.node_count));
  for (Index i = 0; i < wet.model.node_count; ++i) {
    CHECK(bool(has[i]) == wet.is_wet(i));
    const Vec expected{0, 0, wet.is_wet(i) ? -250.0 : 0.0};
    CHECK(distance(vector_at(change.data() + 4 * i), expected) < 1e-11);
  }
  for (const Real again : change_applied(wet.model, wet.state)) CHECK(again == 0);
  const auto work = on_host(applied_of<Water>(wet.state).work);
  CHECK(std::count(work.begin(), work.end(), 0) == wet.model.node_count);
}

TEST_CASE("modules act in their own stage of the step alone") {
  Wet wet;
  const auto sum = on_host(applied_of<Water>(wet.state).sum);
  act_of_modules(wet.model, wet.state, {}, Stage::before_contacts);
  CHECK(sum[4 * wet.top[0] + 2] == 0);
  act_of_modules(wet.model, wet.state, {}, Stage::after_contacts);
  CHECK(sum[4 * wet.top[0] + 2] == doctest::Approx(-250).epsilon(1e-12));
}

TEST_CASE("a model without a module has no applied forces") {
  Scene dry;
  dry.add_box({0, 0, 0}, {1, 1, 1});
  dry.build();
  CHECK(change_applied(dry.model, dry.state).empty());
  CHECK(dry.state.nodes.has_applied.size() == 0);
}

}  // namespace cdem::test
