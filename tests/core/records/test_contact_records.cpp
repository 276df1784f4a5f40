// Rows that contacts and exposed faces are kept in.
#include "core/records/contact_records.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a contact's state is read back from its row, and leaves the others alone") {
  Real rows[24] = {};
  ContactState{1, 2, 3, 4, 5, 6, 7}.store(rows, 1);
  const ContactState s = ContactState::at(rows, 1);
  CHECK(s.force_n == 1);
  CHECK(s.penetration == 2);
  CHECK(s.shear1 == 3);
  CHECK(s.shear2 == 4);
  CHECK(s.stress_free_gap == 5);
  CHECK(s.energy_n == 6);
  CHECK(s.energy_s == 7);
  for (const int k : {0, 7, 15, 16, 23}) CHECK(rows[k] == 0);
}

TEST_CASE("a semi-edge's contact is read back from its row") {
  Index rows[8] = {};
  EdgeContact{10, 11, 12, 13}.store(rows, 1);
  const EdgeContact c = EdgeContact::at(rows, 1);
  CHECK(c.mother == 10);
  CHECK(c.face == 11);
  CHECK(c.edge == 12);
  CHECK(c.before == 13);
  CHECK(rows[3] == 0);
}

TEST_CASE("an exposed face is one cache line; the last side ends at the first corner") {
  CHECK(sizeof(ExposedRow) == 64);
  const ExposedRow quad{{5, 6, 7, 8}, {}, 0, 0, 0, 0};
  const ExposedRow triangle{{5, 6, 7, 7}, {}, 0, 0, 0, 0};
  CHECK(quad.count() == 4);
  CHECK(triangle.count() == 3);
  CHECK(quad.end(0) == 6);
  CHECK(quad.end(3) == 5);
  CHECK(triangle.end(1) == 7);
  CHECK(triangle.end(2) == 5);
}

}  // namespace cdem::test
