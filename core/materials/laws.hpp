// laws.hpp - the list of block laws, and the table of the materials of a model.
#pragma once

#include "core/materials/elastic.hpp"
#include "core/materials/material_table.hpp"
#include "core/materials/mohr_coulomb.hpp"
#include "core/records/law_list.hpp"
#if defined(CDEM_OWN_BLOCK_LAW)  // a law that is built beside those of the list, for a test
#include CDEM_OWN_BLOCK_HEADER
#endif

namespace cdem {

/// Every block law; a new one is one header and its name here.
#if defined(CDEM_OWN_BLOCK_LAW)
using BlockLaws = LawList<Elastic, MohrCoulomb, CDEM_OWN_BLOCK_LAW>;
#else
using BlockLaws = LawList<Elastic, MohrCoulomb>;
#endif

/// Does any law of the list flow?
inline constexpr bool any_law_flows = [] {
  bool any = false;
  BlockLaws::for_each([&]<template <class> class Law, Index>() { any |= Law<Real>::inelastic; });
  return any;
}();

/// Numbers at each Gauss point with inelastic strain: Ei xx yy zz xy yz zx, and the law's state.
inline constexpr Index point_history = 6 + BlockLaws::most_state;

/// The law of this type with the parameters of a material, or of one a lane.
template <template <class> class Law, class Ids>
CDEM_HD inline auto law_of(const MaterialTable& table, const Ids& material) {
  return Law<Number<Ids>>::read([&](Index k) {
    const auto number = [&](Index i) {
      return table.parameters[std::size_t(i) * BlockLaws::most_parameters + k];
    };
    return numbers_of(number, material);
  });
}

/// Increment of the inelastic strain of one point under a trial stress; the law of each lane moves
/// its state on.
template <class T, class Ids>
CDEM_HD inline Sym3<T> flow(const MaterialTable& table, const Ids& material, const Sym3<T>& trial,
                            T* state) {
  const T zero(0.0);
  Sym3<T> increment{zero, zero, zero, zero, zero, zero};
  BlockLaws::for_each([&]<template <class> class Law, Index number>() {
    if constexpr (Law<T>::inelastic) {
      const auto mine = table.has_law<number>(material);
      if (!any_of(mine)) return;
      constexpr Index size = Index(Law<T>::state.size());
      T own[size + 1];
      for (Index k = 0; k < size; ++k) own[k] = state[k];
      const Sym3<T> part = law_of<Law>(table, material).flow(table.elastic(material), trial, own);
      increment = select(mine, part, increment);
      for (Index k = 0; k < size; ++k) state[k] = select(mine, own[k], state[k]);
    }
  });
  return increment;
}

}  // namespace cdem
