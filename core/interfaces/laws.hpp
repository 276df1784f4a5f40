// laws.hpp - the list of interface laws, and who answers for a joint.
#pragma once

#include "core/interfaces/barton_bandis.hpp"
#include "core/interfaces/brittle.hpp"
#include "core/interfaces/closure.hpp"
#include "core/interfaces/continuously_yielding.hpp"
#include "core/interfaces/residual.hpp"
#include "core/interfaces/slip_weakening.hpp"
#include "core/interfaces/softening.hpp"
#include "core/interfaces/table.hpp"
#include "core/interfaces/velocity_weakening.hpp"
#include "core/interfaces/voellmy.hpp"
#include "core/records/law_list.hpp"
#if defined(CDEM_OWN_INTERFACE_LAW)  // a law built in addition to the list, for a test
#include CDEM_OWN_INTERFACE_HEADER
#endif

namespace cdem {

/// Every interface law; a new one is one header and its name here.
#if defined(CDEM_OWN_INTERFACE_LAW)
using InterfaceLaws = LawList<Brittle, Residual, SlipWeakening, Softening, VelocityWeakening,
                              Voellmy, BartonBandis, ContinuouslyYielding, CDEM_OWN_INTERFACE_LAW>;
#else
using InterfaceLaws = LawList<Brittle, Residual, SlipWeakening, Softening, VelocityWeakening,
                              Voellmy, BartonBandis, ContinuouslyYielding>;
#endif
/// The first of them alone. Models without another are many: their kernels ask for no other law.
using BrittleAlone = LawList<Brittle>;

/// Numbers of the parameters of an interface: whole fours, as lanes load them.
inline constexpr Index parameter_row = (InterfaceLaws::most_parameters + 3) / 4 * 4;

inline InterfaceTable table_of(const Interface* interfaces, std::size_t count,
                               const Real* parameters) {
  InterfaceTable table{interfaces, parameters, 0, 0, false};
  for (std::size_t i = 0; i < count; ++i) table.laws |= 1u << interfaces[i].law;
  InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
    table.has_state |= state_count<Law> > 0 && table.has(number);
    if (is_curved<Law> && table.has(number)) table.curved |= 1u << number;
  });
  return table;
}

/// The power of the factor of Scatter that a parameter takes.
template <template <class> class Law, Index parameter>
inline constexpr int scatter_power = Law<Real>::parameters[parameter].scatter;

/// Factor of a pair's strength over its interface's.
template <class T>
struct Scatter {
  bool any = false;
  T factor = T(1.0);

  /// Give the parameters of a law their powers of the factor.
  template <template <class> class Law, Index k = 0>
  CDEM_HD void scale(T* number) const {
    if constexpr (k < parameter_count<Law>) {
      for (int times = 0; times < scatter_power<Law, k>; ++times) number[k] = factor * number[k];
      scale<Law, k + 1>(number);
    }
  }
};

/// A law with the parameters of an interface, or of one a lane.
template <template <class> class Law, class Ids>
CDEM_HD inline auto law_at(const InterfaceTable& table, const Ids& interface,
                           const Scatter<Number<Ids>>& scatter = {}) {
  using T = Number<Ids>;
  const auto place = indices_of([](Index i) { return i * parameter_row; }, interface);
  T number[parameter_row];
  for (Index k = 0; k < parameter_row; k += 4) {
    const Four<T> four = fours_at(table.parameters + k, place);
    number[k] = four.x, number[k + 1] = four.y, number[k + 2] = four.z, number[k + 3] = four.w;
  }
  if (scatter.any) scatter.template scale<Law>(number);
  return Law<T>::read([&](Index k) { return number[k]; });
}

/// The law of a joint: of `Laws` the one of its interface, lane by lane.
template <class Laws, class Ids>
struct JointLaws {
  using T = Number<Ids>;
  static constexpr Index most_state = Laws::most_state;
  const InterfaceTable& table;
  Ids interface;
  Scatter<T> scatter{};

  /// The answer; `state` is the state of the law.
  CDEM_HD JointAnswer<T> respond(const JointInput<T>& in, T* state) const {
    if constexpr (Laws::count == 1) {
      return law_at<Laws::template Only>(table, interface, scatter).respond(in, state);
    } else {
      JointAnswer<T> answer{};
      Laws::for_each([&]<template <class> class Law, Index number>() {
        if (!table.has(number)) return;
        const auto mine = table.has_law<number>(interface);
        if (!any_of(mine)) return;
        constexpr Index size = state_count<Law>;
        T own[size + 1];
        for (Index k = 0; k < size; ++k) own[k] = state[k];
        answer = select(mine, law_at<Law>(table, interface, scatter).respond(in, own), answer);
        for (Index k = 0; k < size; ++k) state[k] = select(mine, own[k], state[k]);
      });
      return answer;
    }
  }
  /// Quick answer for joints that are intact and stay so.
  CDEM_HD Borne<T> bears(const JointInput<T>& in, const T* state) const {
    if constexpr (Laws::count == 1) {
      return law_at<Laws::template Only>(table, interface, scatter).bears(in, state);
    } else {
      const T zero(0.0);
      Borne<T> answer{
          .normal = zero, .shear1 = zero, .shear2 = zero, .stored = zero, .holds = zero > zero};
      Laws::for_each([&]<template <class> class Law, Index number>() {
        if constexpr (requires(const Law<T>& law) { law.bears(in, state); }) {
          if (!table.has(number)) return;
          const auto mine = table.has_law<number>(interface);
          if (!any_of(mine)) return;
          const Borne<T> own = law_at<Law>(table, interface, scatter).bears(in, state);
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
  /// The normal spring of a joint that is pressed so deep  [m].
  CDEM_HD Closure<T> close(const T& depth, const JointStiffness<T>& k) const {
    Closure<T> answer = close_straight(depth, k);
    of_curved([&](const auto& mine, const auto& law) {
      const Closure<T> own = law.close(depth, k);
      answer = {select(mine, own.pressure, answer.pressure),
                select(mine, own.stored, answer.stored)};
    });
    return answer;
  }
  /// How deep it is under a pressure  [Pa].
  CDEM_HD T depth(const T& pressure, const JointStiffness<T>& k) const {
    T answer = k.compliance_n * pressure;
    of_curved([&](const auto& mine, const auto& law) {
      answer = select(mine, law.depth(pressure, k), answer);
    });
    return answer;
  }
  /// The lanes whose law has state.
  CDEM_HD Truth<T> remember() const {
    Truth<T> any = T(0.0) > T(0.0);
    Laws::for_each([&]<template <class> class Law, Index number>() {
      if constexpr (state_count<Law> > 0)
        if (table.has(number)) any = any | table.has_law<number>(interface);
    });
    return any;
  }

 private:
  /// Call act(lanes, law) for every law with a curve that a lane has.
  template <class Act>
  CDEM_HD void of_curved(const Act& act) const {
    Laws::for_each([&]<template <class> class Law, Index number>() {
      if constexpr (is_curved<Law>) {
        if (!table.has(number)) return;
        const auto mine = table.has_law<number>(interface);
        if (any_of(mine)) act(mine, law_at<Law>(table, interface, scatter));
      }
    });
  }
};

/// How deep a joint of an interface is under a pressure [Pa]  [m].
CDEM_HD inline Real depth_under(const InterfaceTable& table, Index interface, Real pressure,
                                const JointStiffness<Real>& k) {
  if (!table.closes_by_curve(interface)) return pressure / k.n;
  return JointLaws<InterfaceLaws, Index>{table, interface}.depth(max_of(pressure, 0.0), k);
}

/// Does the law of this number ask for the area of contacts, with these parameters?
inline bool asks_area(Index law, const Real* parameters) {
  bool asks = false;
  InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
    if (number != law) return;
    asks = true;
    if constexpr (requires { Law<Real>::asks_area(parameters); })
      asks = Law<Real>::asks_area(parameters);
  });
  return asks;
}

/// A kernel that asks laws, limited to some of them: its `update<Laws>`.
template <class Kernel, class Laws>
struct WithLaws : Kernel {
  template <class I>
  CDEM_HD void operator()(const I& item) const {
    Kernel::template update<Laws>(item);
  }
};
/// Call launch(kernel) with the kernel for the laws that a model has.
template <class Kernel, class Launch>
void with_laws(const InterfaceTable& table, const Kernel& kernel, const Launch& launch) {
  if (table.is_brittle())
    launch(WithLaws<Kernel, BrittleAlone>{kernel});
  else
    launch(WithLaws<Kernel, InterfaceLaws>{kernel});
}

template <class Laws, class Ids>
CDEM_HD inline JointLaws<Laws, Ids> joint_laws(const InterfaceTable& table, const Ids& interface) {
  return {table, interface};
}

}  // namespace cdem
