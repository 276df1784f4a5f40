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

/// A joint at this place that does not rise, with its area and without a dashpot.
inline JointInput<Real> joint_at(Real opening, Real shear1, Real kn, Real ks, Real bond) {
  return {.opening = opening,
          .shear1 = shear1,
          .shear2 = 0,
          .stiffness = JointStiffness<Real>::of(kn, ks),
          .damping = 0,
          .bond = bond,
          .risen = 0,
          .rate1 = 0,
          .rate2 = 0,
          .has_area = 1};
}

/// The same from eight numbers or packs, as `check_lanes` gives them.
template <class T>
JointInput<T> joint_of(const T* in, Real kn, Real ks) {
  return {.opening = in[0],
          .shear1 = in[1],
          .shear2 = in[2],
          .stiffness = JointStiffness<T>::of(T(kn), T(ks)),
          .damping = in[3],
          .bond = in[4],
          .risen = in[5],
          .rate1 = T(0.0),
          .rate2 = T(0.0),
          .has_area = in[7]};
}

}  // namespace cdem::test
