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
  void change(Index before, Index now) {
    State& s = state;
    s.springs.target_before[slot] = before;
    s.springs.target[slot] = now;
    held.store(s.springs.state.data(), slot);
    for (Index k = 0; k < 8; ++k) s.springs.reaction[8 * slot + k] = 9;
    for_each_item({}, Index(s.search.exposed_face.size()),
                  ChangeTargets{face_columns(model, s), face_geometry(s), model.rules,
                                contact_laws(model, s), spring_columns(s)});
  }
  ContactState now() const { return ContactState::at(state.springs.state.data(), slot); }
};

}  // namespace

TEST_CASE("a contact that goes on, or begins, is left as it is") {
  for (const Index before : {top, Index(-1)}) {
    Corner corner;
    corner.change(before, top);
    CHECK(corner.now().force_n == held.force_n);
    CHECK(corner.now().shear2 == held.shear2);
    CHECK(corner.state.springs.reaction[8 * corner.slot] == 9);
  }
}

TEST_CASE("a contact that ended forgets its force, and books what it did not give back") {
  Corner corner;
  corner.change(top, -1);
  CHECK(corner.now().force_n == 0);
  CHECK(corner.now().shear1 == 0);
  CHECK(corner.now().energy_n == 0);
  CHECK(corner.state.springs.reaction[8 * corner.slot] == 0);
  // nothing moved: all of it is lost
  CHECK(corner.state.springs.dashpot[corner.slot] == held.energy_n);
  CHECK(corner.state.springs.friction[corner.slot] == held.energy_s);
}

TEST_CASE(
    "a contact that moves to another face keeps the length of its shear force and its energy") {
  Corner corner;
  corner.change(top, side);
  const ContactState s = corner.now();
  CHECK(relative_error(std::hypot(s.shear1, s.shear2), 5e3) < 1e-14);
  const ContactLaws laws = contact_laws(corner.model, corner.state);
  const FaceGeometry geometry = face_geometry(corner.state);
  const Index mother = corner.slot / 4;
  const Real kn = 0.5 * laws.spring(geometry, Index(0), mother, side).n();
  CHECK(relative_error(0.5 * kn * s.penetration * s.penetration, held.energy_n) < 1e-15);
  // until it has its new force, its energies are what the springs did not give back
  CHECK(s.energy_n == held.energy_n);
  CHECK(s.energy_s == held.energy_s);
  CHECK(corner.state.springs.friction[corner.slot] == 0);
}

}  // namespace cdem::test
