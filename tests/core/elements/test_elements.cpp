// Forces of all elements of a model, in every formulation.
#include "core/elements/elements.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// One element of each shape, deformed.
struct Shapes : Scene {
  explicit Shapes(Formulation formulation) {
    model.formulation = formulation;
    add<Hex8>(Reference<Hex8>::corners());
    add<Wedge6>(at(Reference<Wedge6>::corners(), 10));
    add<Pyramid5>(at(Reference<Pyramid5>::corners(), 20));
    add<Tet4>(at(Reference<Tet4>::corners(), 30));
    build();
    state.dt = state.dt_last = 1e-4;
    Random random(1);
    for (Index i = 0; i < model.node_count; ++i) {
      const Vec shift = random.vector(1e-5);
      put(motion(i), position(i) + shift);
      put(motion(i) + 4, Real(1 / state.dt_last) * shift);  // came here in one step
    }
  }
  void update() { update_element_forces(model, state, {}, {.everything_awake = true}); }
  /// Of the only element of a node.
  Vec force(Index node) const { return vector_at(state.tile_force.data() + 4 * node); }

 private:
  template <class Corners>
  static Corners at(Corners corners, Real x) {
    for (Vec& c : corners) c = c + Vec{x, 0, 0};
    return corners;
  }
};

}  // namespace

TEST_CASE("every tile writes its own rows: forces that sum to zero") {
  Shapes shapes(Formulation::corotational);
  shapes.update();
  const Real stiff = shapes.rock.young_modulus();
  for (Index b = 0; b < 4; ++b) {
    Vec sum{0, 0, 0};
    for (Index i = 0; i < shapes.node_count(b); ++i) {
      const Vec f = shapes.force(shapes.first_node(b) + i);
      CHECK(norm(f) > 1e-7 * stiff);
      sum = sum + f;
    }
    CHECK(norm(sum) < 2e-20 * stiff);
  }
}

TEST_CASE("for a small step from rest all formulations give the same forces") {
  Shapes total(Formulation::corotational);
  total.update();
  const Real stiff = total.rock.young_modulus();
  for (const Formulation other :
       {Formulation::incremental, Formulation::paper_incremental, Formulation::paper_total}) {
    Shapes shapes(other);
    shapes.update();
    Real worst = 0;
    for (Index i = 0; i < shapes.model.node_count; ++i)
      worst = std::max(worst, distance(shapes.force(i), total.force(i)));
    CHECK(worst > 0);  // another form
    CHECK(worst < 1e-9 * stiff);
  }
}

TEST_CASE("elements that are not awake keep their forces") {
  Shapes shapes(Formulation::corotational);
  shapes.update();
  const Index of_tet = shapes.first_node(3);
  const Vec before = shapes.force(0), tet_before = shapes.force(of_tet);
  shapes.motion(0)[0] += 0.1;
  shapes.state.tet4.awake.assign({0});
  shapes.motion(of_tet)[0] += 0.1;
  update_element_forces(shapes.model, shapes.state, {}, {});
  CHECK(distance(shapes.force(0), before) == 0);
  CHECK(distance(shapes.force(of_tet), tet_before) > 0);
}

}  // namespace cdem::test
