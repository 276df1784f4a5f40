// Semi-springs that move to another face, or whose contact ends.
#include "core/base/parallel.hpp"
#include "core/contact/force/change_of_target.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

constexpr Index top = 1, side = 3;  // faces of the box
const ContactState held{.force_n = 1e4,
                        .penetration = 1e-3,
                        .shear1 = 3e3,
                        .shear2 = 4e3,
                        .stress_free_gap = 0,
                        .energy_n = 5,
                        .energy_s = 7};

/// A box, and a tet with its tip, slot 24, at rest on the edge between top and side.
struct Corner : Scene {
  static constexpr Index slot = 24;

  Corner() {
    add_box({0, 0, 0}, {2, 2, 2});
    add<Tet4>({{{2, 1, 2}, {2.5, 1, 3}, {1.7, 1.4, 3}, {1.7, 0.6, 3}}});
    build();
    start();
    update_all_face_geometry(model, state, {});
    state.dt_last = 1e-4;
  }
  void change(Index before, Index now, const ContactState& held = test::held) {
    State& s = state;
    on_host(s.springs.target_before)[slot] = before;
    on_host(s.springs.target)[slot] = now;
    held.store(s.springs.state.data(), slot);
    for (Index k = 0; k < 8; ++k) on_host(s.springs.reaction)[8 * slot + k] = 9;
    for_each_item({}, Index(s.search.exposed_face.size()),
                  ChangeTargets{face_columns(model, s), face_geometry(s), model.rules,
                                contact_laws(model, s), spring_columns(s)});
  }
  ContactState now() const { return ContactState::at(state.springs.state.data(), slot); }
  /// K_n of its contact with a face  [N/m].
  Real kn(Index target) const {
    const Index mother = slot / 4;
    return 0.5 *
           contact_laws(model, state).spring(face_geometry(state), Index(0), mother, target).n();
  }
};

}  // namespace

TEST_CASE("a contact that goes on, or begins, is left as it is") {
  for (const Index before : {top, Index(-1)}) {
    Corner corner;
    corner.change(before, top);
    CHECK(corner.now().force_n == held.force_n);
    CHECK(corner.now().shear2 == held.shear2);
    CHECK(on_host(corner.state.springs.reaction)[8 * corner.slot] == 9);
  }
}

TEST_CASE("a contact that ended forgets its force, and books what it did not give back") {
  Corner corner;
  corner.change(top, -1);
  CHECK(corner.now().force_n == 0);
  CHECK(corner.now().shear1 == 0);
  CHECK(corner.now().energy_n == 0);
  CHECK(on_host(corner.state.springs.reaction)[8 * corner.slot] == 0);
  // nothing moved: all of it is lost
  CHECK(on_host(corner.state.springs.dashpot)[corner.slot] == held.energy_n);
  CHECK(on_host(corner.state.springs.friction)[corner.slot] == held.energy_s);
}

TEST_CASE(
    "a contact that moves to another face keeps the length of its shear force and its energy") {
  Corner corner;
  corner.change(top, side);
  const ContactState s = corner.now();
  CHECK(relative_error(std::hypot(s.shear1, s.shear2), 5e3) < 1e-14);
  CHECK(relative_error(0.5 * corner.kn(side) * s.penetration * s.penetration, held.energy_n) <
        1e-15);
  // until it has its new force, its energies are what the springs did not give back
  CHECK(s.energy_n == held.energy_n);
  CHECK(s.energy_s == held.energy_s);
  CHECK(on_host(corner.state.springs.friction)[corner.slot] == 0);
}

TEST_CASE("a contact that has unloaded keeps its share of the approach on the next face") {
  Corner corner;
  corner.change_interface(0, [](Interface& i) { i.returned_n = 0.25; });
  ContactState unloaded = held;
  unloaded.energy_n = 2;
  unloaded.penetration = std::sqrt(2 * 2 / (0.25 * corner.kn(top)));
  unloaded.approach = 1.6 * unloaded.penetration;
  corner.change(top, side, unloaded);
  const ContactState s = corner.now();
  CHECK(relative_error(s.approach / s.penetration, 1.6) < 1e-14);
  CHECK(relative_error(0.5 * 0.25 * corner.kn(side) * s.penetration * s.penetration, 2) < 1e-14);
}

namespace {

/// A box that stands still, with a loaded spring in a face of a tet.
struct Loaded : Scene {
  static constexpr Index slot = 1;            // of the first face of the box
  static constexpr Index before = 7, to = 9;  // faces of the tet
  ContactState old{.force_n = 30,
                   .penetration = 1e-3,
                   .shear1 = 4,
                   .shear2 = -7,
                   .stress_free_gap = -1e-4,
                   .energy_n = 0.02,
                   .energy_s = 0.005};

  Loaded() {
    Random random(2);
    add_box({0, 0, 0}, {1, 1, 1});
    add_tet(random, {0.5, 0.5, 1.5}, 1);
    build();
    start();
    step(1);
    on_host(state.springs.target_before)[slot] = before;
    old.store(state.springs.state.data(), slot);
    for (Index k = 0; k < 8; ++k) on_host(state.springs.reaction)[8 * slot + k] = 1;
  }
  ContactState change(Index target) {
    on_host(state.springs.target)[slot] = target;
    for_each_item({}, Index(state.search.exposed_face.size()), kernel());
    return ContactState::at(state.springs.state.data(), slot);
  }
  ChangeTargets kernel() {
    return {face_columns(model, state), face_geometry(state), model.rules,
            contact_laws(model, state), spring_columns(state)};
  }
  Frame<Real> frame(Index x) {
    return face_columns(model, state).shape(on_host(state.search.exposed_face)[x]).frame();
  }
};

}  // namespace

TEST_CASE("a contact that moves keeps its shear, turned into the new plane, and its energy") {
  Loaded box;
  const Frame<Real> from = box.frame(box.before), to = box.frame(box.to);
  const ContactState moved = box.change(box.to);
  const Vec held = box.old.shear1 * from.t1 + box.old.shear2 * from.t2;
  const Vec along = held - dot(held, to.n) * to.n;
  const Vec now = moved.shear1 * to.t1 + moved.shear2 * to.t2;
  CHECK(norm(along) < 0.99 * norm(held));
  CHECK(distance(now, (norm(held) / norm(along)) * along) < 1e-14 * norm(held));
  const ChangeTargets kernel = box.kernel();
  const Real kn =
      kernel.laws
          .spring(kernel.geometry, kernel.laws.between(kernel.geometry, 0, box.to), 0, box.to)
          .n();
  // semi-springs of both blocks share the area
  CHECK(relative_error(0.5 * 0.5 * kn * moved.penetration * moved.penetration, box.old.energy_n) <
        1e-14);
}

TEST_CASE("a contact that ends forgets its forces, and what it held is lost") {
  Loaded box;
  const ContactState ended = box.change(-1);
  CHECK(ended.force_n == 0);
  CHECK(ended.shear1 == 0);
  CHECK(ended.shear2 == 0);
  CHECK(ended.energy_n == 0);
  CHECK(ended.energy_s == 0);
  for (Index k = 0; k < 4; ++k) CHECK(on_host(box.state.springs.reaction)[8 * box.slot + k] == 0);
  // nothing moves but by round-off
  CHECK(relative_error(on_host(box.state.springs.friction)[box.slot], box.old.energy_s) < 1e-10);
  CHECK(relative_error(on_host(box.state.springs.dashpot)[box.slot], box.old.energy_n) < 1e-10);
}

TEST_CASE("a contact that stays on its face is left alone") {
  Loaded box;
  const ContactState kept = box.change(box.before);
  CHECK(kept.force_n == box.old.force_n);
  CHECK(kept.shear2 == box.old.shear2);
  CHECK(on_host(box.state.springs.friction)[box.slot] == 0);
}

}  // namespace cdem::test
