// linear_elastic.hpp - isotropic linear elasticity: stress = lambda tr(strain) I + 2 mu strain.
#pragma once

#include "core/base/views.hpp"

namespace cdem {

/// Isotropic linear elastic law, in the unrotated frame of the element; [D] of Feng et al. (2014),
/// Eq. 2. Strain and stress are positive in tension. A law of another kind is another such struct.
template <class T>
struct LinearElastic {
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

/// The materials of the model, one entry each; an element holds the index of its own.
struct MaterialTable {
  const Real *lambda, *mu;  // [Pa]

  template <class Key>
  CDEM_HD auto at(const Key& key) const {
    auto l = look_up(lambda, key);
    return LinearElastic<decltype(l)>{l, look_up(mu, key)};
  }
};

}  // namespace cdem
