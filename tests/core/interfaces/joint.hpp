// joint.hpp - interfaces with the brittle law, for the tests of what calls it.
#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "core/interfaces/laws.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

using Named = std::initializer_list<std::pair<const char*, Real>>;

/// Parameters of the brittle law by name, those that are not named being 0; an angle is its
/// tangent.
inline std::vector<Real> brittle_parameters(const Named& named) {
  constexpr auto& all = Brittle<Real>::parameters;
  std::vector<Real> numbers(parameter_row);
  for (const auto& [name, value] : named) {
    std::size_t k = 0;
    while (k < all.size() && std::string_view(all[k].name) != name) ++k;
    if (k == all.size()) throw std::invalid_argument(name);
    numbers[k] = value;
  }
  return numbers;
}

/// A table of interfaces; each has the brittle law.
struct Joints {
  std::vector<Interface> interfaces;
  std::vector<Real> parameters;

  Joints(std::initializer_list<Named> each) {
    for (const Named& named : each) {
      interfaces.push_back({.law = 0,
                            .in_series = false,
                            .stiffness_n_value = 0,
                            .stiffness_n_factor = 1,
                            .stiffness_s_value = 0,
                            .stiffness_s_factor = 1});
      for (const Real number : brittle_parameters(named)) parameters.push_back(number);
    }
  }
  InterfaceTable table() const {
    return table_of(interfaces.data(), interfaces.size(), parameters.data());
  }
  Brittle<Real> law(Index interface) const { return law_at<Brittle>(table(), interface); }
};

}  // namespace cdem::test
