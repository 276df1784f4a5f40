// Interfaces of contacts by pair of face classes.
#include "core/contact/force/contact_laws.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/views.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Two boxes whose faces are of two classes.
struct TwoClasses : Scene {
  TwoClasses() {
    add_box({0, 0, 0}, {1, 1, 1});
    add_box({0, 0, 2}, {2, 2, 2});
    build();
    model.class_count = 2;
    const Index of[] = {0, 1, 1, 2};
    model.interface_of.assign(of, 4);
    const Interface rows[] = {
        {0, false, 5e9, 0, 0, 3}, {0, false, 0, 2, 7e8, 0}, {0, true, 0, 1, 0, 1}};
    model.interfaces.assign(rows, 3);
    note_interfaces(model);
    for (Index f = 6; f < 12; ++f) on_host(model.face_interface_class)[f] = 1;
    start();
  }
};

}  // namespace

TEST_CASE("the classes of two faces choose the interface, for one pair and for a lane") {
  const TwoClasses blocks;
  const ContactLaws laws = contact_laws(blocks.model, blocks.state);
  const FaceGeometry geometry = face_geometry(blocks.state);
  CHECK(laws.between(geometry, 0, 3) == 0);
  CHECK(laws.between(geometry, 0, 8) == 1);
  CHECK(laws.between(geometry, 8, 0) == 1);
  CHECK(laws.between(geometry, 7, 8) == 2);
  IndexPack m, t;
  for (Index j = 0; j < lanes; ++j) m.id[j] = j % 12, t.id[j] = (5 * j + 3) % 12;
  const IndexPack interface = laws.between(geometry, m, t);
  const ContactSpring<Pack> springs = laws.spring(geometry, interface, m, t);
  for (Index j = 0; j < lanes; ++j) {
    CHECK(interface.id[j] == laws.between(geometry, m.id[j], t.id[j]));
    const auto spring = laws.spring(geometry, interface.id[j], m.id[j], t.id[j]);
    CHECK(springs.area.n[j] == spring.area);
    CHECK(springs.stiffness.n.n[j] == spring.stiffness.n);
    CHECK(springs.stiffness.s.n[j] == spring.stiffness.s);
  }
}

TEST_CASE("a stiffness is the given value, or a factor times the stiffer side or both in series") {
  const TwoClasses blocks;
  const ContactLaws laws = contact_laws(blocks.model, blocks.state);
  const FaceGeometry geometry = face_geometry(blocks.state);
  const Real young = blocks.rock.young_modulus();
  const auto same = laws.spring(geometry, Index(0), Index(0), Index(1));
  CHECK(same.stiffness.n == 5e9);
  CHECK(relative_error(same.stiffness.s, 3 * young) < 1e-15);
  const auto both = laws.spring(geometry, Index(1), Index(0), Index(8));
  CHECK(relative_error(both.stiffness.n, 2 * young) < 1e-15);  // the box of 1 m is stiffer
  CHECK(both.stiffness.s == 7e8);
  CHECK(both.area == 0.25);  // a vertex's share of the smaller face
  CHECK(relative_error(both.n(), 0.25 * 2 * young) < 1e-15);
  const auto series = laws.spring(geometry, Index(2), Index(0), Index(8));  // of E and E/2
  CHECK(relative_error(series.stiffness.n, 2 * young / 3) < 1e-15);
  CHECK(relative_error(laws.spring(geometry, Index(2), Index(0), Index(1)).n(), 0.25 * young) <
        1e-15);
}

TEST_CASE("contacts of an interface give back its share, for one pair and for a lane") {
  TwoClasses blocks;
  blocks.change_interface(1, [](Interface& i) { i.returned_n = 0.25, i.returned_s = 0.64; });
  const FaceInterfaces faces = contact_laws(blocks.model, blocks.state).faces;
  const ExposedRow* table = face_geometry(blocks.state).table;
  CHECK(faces.returned_n(faces.between(table, 0, 8)) == 0.25);
  CHECK(faces.returned_s(faces.between(table, 8, 0)) == 0.64);
  CHECK(faces.returned_n(faces.between(table, 7, 8)) == 1);
  IndexPack interface;
  for (Index j = 0; j < lanes; ++j) interface.id[j] = j % 3;
  const Pack returned = faces.returned_n(interface);
  for (Index j = 0; j < lanes; ++j) CHECK(returned.n[j] == (j % 3 == 1 ? 0.25 : 1));
}

TEST_CASE("the dashpot is a part of the critical one of its spring and masses") {
  TwoClasses blocks;
  blocks.model.contact_damping = 0.1;
  const ContactLaws laws = contact_laws(blocks.model, blocks.state);
  const ContactSpring<Real> spring{.area = 0.5, .stiffness = JointStiffness<Real>::of(8, 1)};
  CHECK(relative_error(laws.dashpot(spring, 0.25), 2 * 0.1 * std::sqrt(4 * 4.0)) < 1e-15);
}

}  // namespace cdem::test
