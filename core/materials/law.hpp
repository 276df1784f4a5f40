// law.hpp - input and answer of a block law.
//
// Every block law is elastic up to where it flows: stress = C : (E - Ei), with the strain E and the
// inelastic strain Ei in the unrotated frame of the element. A law is a template <class T> struct
// of its parameters, T a number or a pack, with
//
//   static constexpr LawText text;                     name in a case, meaning
//   static constexpr std::array<Parameter, n> parameters;   besides the elastic constants
//   static constexpr std::array<StateVariable, n> state;    besides Ei
//   static constexpr bool inelastic;                   does it ever flow?
//   static const char* contradiction(const Real*);     why parameters do not fit, or nullptr
//
//   static constexpr std::array<const char*, n> softening;   if you like: the names of the first
//                                                      numbers that it reads, which may fall,
//                                                      see softening.hpp
//
// and where it is inelastic
//
//   static std::array<Real, m> prepare(const Real*);   numbers that kernels read, from the
//                                                      parameters; without it, those
//   static Law read(number);                           number(k) is number k of them
//   Sym3<T> flow(const ElasticConstants<T>&, const Sym3<T>& trial, T* state) const;
//                                                      increment of Ei, from the trial stress; the
//                                                      state may change only where it is not zero
//   Truth<T> surely_elastic(const Sym3<T>& trial) const;   if you like: a quick answer for most
//
// It must not be stiffer than C: the time step is found for that.
#pragma once

#include "core/base/math.hpp"
#include "core/records/law_declaration.hpp"

namespace cdem {

/// Isotropic elasticity: stress = lambda tr(strain) I + 2 mu strain; [D] of Feng et al. (2014),
/// Eq. 2. Strain and stress are positive in tension.
template <class T>
struct ElasticConstants {
  T lambda;  // first Lame constant  [Pa]
  T mu;      // shear modulus        [Pa]

  CDEM_HD Sym3<T> stress(const Sym3<T>& strain) const {
    const T pressure = lambda * trace(strain);
    const T twice_mu = mu + mu;
    return {pressure + twice_mu * strain.xx,
            pressure + twice_mu * strain.yy,
            pressure + twice_mu * strain.zz,
            twice_mu * strain.xy,
            twice_mu * strain.yz,
            twice_mu * strain.zx};
  }
};

}  // namespace cdem
