// laws.hpp - the list of interface laws, and the table of the interfaces of a model.
#pragma once

#include "core/base/views.hpp"
#include "core/interfaces/brittle.hpp"
#include "core/records/interface.hpp"
#include "core/records/law_list.hpp"
#if defined(CDEM_OWN_INTERFACE_LAW)  // a law that is built beside those of the list, for a test
#include CDEM_OWN_INTERFACE_HEADER
#endif

namespace cdem {

/// Every interface law; a new one is one header and its name here.
#if defined(CDEM_OWN_INTERFACE_LAW)
using InterfaceLaws = LawList<Brittle, CDEM_OWN_INTERFACE_LAW>;
#else
using InterfaceLaws = LawList<Brittle>;
#endif

/// The interfaces of a model and the parameters of their laws.
struct InterfaceTable {
  /// Numbers in a row of parameters: whole fours, as lanes load them.
  static constexpr Index row = (InterfaceLaws::most_parameters + 3) / 4 * 4;
  const Interface* interfaces;
  const Real* parameters;  // [interface][row]

  /// Number of the law of an interface, or of one a lane.
  template <class Ids>
  CDEM_HD Ids law_of(const Ids& interface) const {
    return indices_of([&](Index i) { return interfaces[i].law; }, interface);
  }
  /// The lanes that have law `number`.
  template <Index number, class Ids>
  CDEM_HD Truth<Number<Ids>> has_law(const Ids& interface) const {
    const auto own = [&](Index i) { return Real(interfaces[i].law == number); };
    return numbers_of(own, interface) > Number<Ids>(0.5);
  }
  /// The law of an interface with its parameters.
  template <template <class> class Law, class Ids>
  CDEM_HD auto law(const Ids& interface) const {
    using T = Number<Ids>;
    const auto place = indices_of([](Index i) { return i * row; }, interface);
    T number[row];
    for (Index k = 0; k < row; k += 4) {
      const Four<T> four = fours_at(parameters + k, place);
      number[k] = four.x, number[k + 1] = four.y, number[k + 2] = four.z, number[k + 3] = four.w;
    }
    return Law<T>::read([&](Index k) { return number[k]; });
  }
};

/// The law of each lane answers; `state` are the numbers that it remembers.
template <class T, class Ids>
CDEM_HD inline JointAnswer<T> respond(const InterfaceTable& table, const Ids& interface,
                                      const JointInput<T>& in, T* state) {
  if constexpr (InterfaceLaws::count == 1) {
    return table.law<InterfaceLaws::Only>(interface).respond(in, state);
  } else {
    JointAnswer<T> answer{};
    InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
      const auto mine = table.has_law<number>(interface);
      if (!any_of(mine)) return;
      constexpr Index size = Index(Law<T>::state.size());
      T own[size + 1];
      for (Index k = 0; k < size; ++k) own[k] = state[k];
      answer = select(mine, table.law<Law>(interface).respond(in, own), answer);
      for (Index k = 0; k < size; ++k) state[k] = select(mine, own[k], state[k]);
    });
    return answer;
  }
}

/// The lanes whose law has state.
template <class Ids>
CDEM_HD inline Truth<Number<Ids>> remembers(const InterfaceTable& table, const Ids& interface) {
  using T = Number<Ids>;
  Truth<T> any = T(0.0) > T(0.0);
  InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
    if constexpr (Law<T>::state.size() > 0) any = any | table.has_law<number>(interface);
  });
  return any;
}

/// Quick answer for joints that are intact and stay so, of laws without state.
template <class T, class Ids>
CDEM_HD inline Borne<T> bears(const InterfaceTable& table, const Ids& interface,
                              const JointInput<T>& in) {
  if constexpr (InterfaceLaws::count == 1) {
    return table.law<InterfaceLaws::Only>(interface).bears(in);
  } else {
    const T zero(0.0);
    Borne<T> answer{
        .normal = zero, .shear1 = zero, .shear2 = zero, .stored = zero, .holds = zero > zero};
    InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
      if constexpr (Law<T>::state.size() == 0) {
        const auto mine = table.has_law<number>(interface);
        if (!any_of(mine)) return;
        const Borne<T> own = table.law<Law>(interface).bears(in);
        answer = {.normal = select(mine, own.normal, answer.normal),
                  .shear1 = select(mine, own.shear1, answer.shear1),
                  .shear2 = select(mine, own.shear2, answer.shear2),
                  .stored = select(mine, own.stored, answer.stored),
                  .holds = Truth<T>((mine & own.holds) | answer.holds)};
      }
    });
    return answer;
  }
}

}  // namespace cdem
