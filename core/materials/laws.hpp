// laws.hpp - the list of block laws, and the table of the materials of a model.
#pragma once

#include <tuple>

#include "core/materials/drucker_prager.hpp"
#include "core/materials/elastic.hpp"
#include "core/materials/hoek_brown.hpp"
#include "core/materials/material_table.hpp"
#include "core/materials/mohr_coulomb.hpp"
#include "core/materials/softening.hpp"
#include "core/materials/ubiquitous_joint.hpp"
#include "core/records/law_list.hpp"
#if defined(CDEM_OWN_BLOCK_LAW)  // a law built in addition to the list, for a test
#include CDEM_OWN_BLOCK_HEADER
#endif

namespace cdem {

template <class T>
using UbiquitousJoint = JointedRock<T, MohrCoulomb>;

/// Every block law; a new one is one header and its name here.
#if defined(CDEM_OWN_BLOCK_LAW)
using BlockLaws =
    LawList<Elastic, MohrCoulomb, UbiquitousJoint, DruckerPrager, HoekBrown, CDEM_OWN_BLOCK_LAW>;
#else
using BlockLaws = LawList<Elastic, MohrCoulomb, UbiquitousJoint, DruckerPrager, HoekBrown>;
#endif

/// Does any law of the list flow?
inline constexpr bool any_law_flows = [] {
  bool any = false;
  BlockLaws::for_each([&]<template <class> class Law, Index>() { any |= Law<Real>::inelastic; });
  return any;
}();

/// Numbers of a law that kernels read.
template <template <class> class Law>
constexpr Index numbers_read() {
  if constexpr (requires { &Law<Real>::prepare; })
    return Index(std::tuple_size_v<decltype(Law<Real>::prepare(nullptr))>);
  else
    return parameter_count<Law>;
}

/// The most of them that any law has.
inline constexpr Index law_numbers = [] {
  Index most = 0;
  BlockLaws::for_each([&]<template <class> class Law, Index>() {
    most = numbers_read<Law>() > most ? numbers_read<Law>() : most;
  });
  return most;
}();

/// Numbers of a material: parameters of its law, then their softening.
inline constexpr Index material_row = law_numbers + softening_numbers;

/// Numbers at each Gauss point with inelastic strain: Ei xx yy zz xy yz zx, and the law's state.
inline constexpr Index point_history = 6 + BlockLaws::most_state;

/// How many of a law's numbers may fall.
template <template <class> class Law>
inline constexpr Index numbers_that_fall = [] {
  if constexpr (requires { Law<Real>::softening; })
    return Index(Law<Real>::softening.size());
  else
    return Index(0);
}();

/// Plastic strain at a point in a step.
template <class T>
struct PointIncrement {
  bool any = false;                    // where not, the rest says nothing
  Sym3<T> strain;                      // of the inelastic strain
  T state[BlockLaws::most_state + 1];  // after the step
};

/// Response of one law to a trial stress, for its lanes; `rows` has the state that the
/// point is in and the size of its element. Defined in flow_by.hpp: one copy for all kernels, which
/// would else take minutes to build.
template <template <class> class Law, class T, class Ids, class Rows>
CDEM_OUT_OF_LINE void flow_by(const MaterialTable& table, const Ids& material, const Truth<T>& mine,
                              const Sym3<T>& trial, const Rows& rows, PointIncrement<T>& out);

/// Plastic strain at one point under a trial stress, each lane by the law of this number.
template <class T, class Ids, class Rows>
CDEM_HD inline PointIncrement<T> flow(const MaterialTable& table, const Ids& material, const T& law,
                                      const Sym3<T>& trial, const Rows& rows) {
  PointIncrement<T> out;
  BlockLaws::for_each([&]<template <class> class Law, Index number>() {
    if constexpr (Law<T>::inelastic) {
      const auto mine = (law > T(number - 0.5)) & (law < T(number + 0.5));
      if (any_of(mine)) flow_by<Law>(table, material, mine, trial, rows, out);
    }
  });
  return out;
}

}  // namespace cdem
