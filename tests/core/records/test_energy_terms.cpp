// The terms of the energy ledger.
#include <set>
#include <string>

#include "core/records/energy_terms.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("every term has a name of its own, by which it is found") {
  std::set<std::string> names;
  for (const EnergyTerm& term : energy_terms) CHECK(names.insert(term.name).second);
  CHECK(std::string(energy_terms[energy_term("friction")].name) == "friction");
  CHECK(energy_terms[energy_term("kinetic")].kind == EnergyKind::stored);
  CHECK(energy_terms[energy_term("damping")].kind == EnergyKind::lost);
  CHECK(energy_terms[energy_term("external")].kind == EnergyKind::supplied);
}

}  // namespace cdem::test
