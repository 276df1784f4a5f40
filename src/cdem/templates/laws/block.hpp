// block.hpp - the block law `perfectly-plastic`: von Mises plasticity without hardening. One header
// is a whole law: docs/contributing/adding_a_law.md.
#pragma once

#include <array>

#include "core/materials/law.hpp"

namespace cdem {

/// Flows where sqrt(3/2 s:s), s the deviator of the stress, reaches the yield stress.
template <class T>
struct PerfectlyPlastic {
  static constexpr LawText text{.name = "perfectly-plastic",
                                .meaning = "Elastic, then von Mises without hardening"};
  static constexpr std::array parameters{Parameter{.name = "yield_stress",
                                                   .symbol = "Y",
                                                   .unit = "Pa",
                                                   .meaning = "Uniaxial yield stress",
                                                   .is_strength = true}};
  static constexpr std::array state{StateVariable{
      .name = "plastic_strain", .unit = "1", .meaning = "sqrt(2/3 Ep:Ep), summed over increments"}};
  static constexpr bool inelastic = true;
  static const char* contradiction(const Real*) { return nullptr; }

  T yield_stress;

  template <class Number>
  CDEM_HD static PerfectlyPlastic read(const Number& number) {
    return {.yield_stress = number(0)};
  }
  CDEM_HD Sym3<T> flow(const ElasticConstants<T>& elastic, const Sym3<T>& trial, T* state) const {
    const T zero(0.0);
    const Sym3<T> deviator = with_trace(trial, zero);
    const T size = sqrt_of(T(1.5) * contract(deviator, deviator));
    const T strain = max_of(size - yield_stress, zero) / (T(3.0) * elastic.mu);
    state[0] += strain;
    return select(strain > zero, T(1.5) * strain / size, zero) * deviator;
  }
};

}  // namespace cdem
