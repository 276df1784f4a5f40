// elastic.hpp - isotropic linear elasticity, which never flows.
#pragma once

#include <array>

#include "core/base/lanes.hpp"
#include "core/records/law_declaration.hpp"

namespace cdem {

template <class T>
struct Elastic {
  static constexpr LawText text{.name = "elastic", .meaning = "Isotropic linear elasticity"};
  static constexpr std::array<Parameter, 0> parameters{};
  static constexpr std::array<StateVariable, 0> state{};
  static constexpr bool inelastic = false;
  static const char* contradiction(const Real*) { return nullptr; }
};

}  // namespace cdem
