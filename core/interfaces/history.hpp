// history.hpp - state of interface laws, stored at the walls of contacts.
#pragma once

#include "core/interfaces/laws.hpp"

namespace cdem {

/// State of a law at a loose face.
template <template <class> class Law, Index k>
inline constexpr Real loose_value = Law<Real>::state[k].loose;

/// Histories of vertices or sides of exposed faces, a row each: it belongs to the wall, so it stays
/// when a contact ends or meets another face. Empty where no law of the model has state.
struct HistoryRows {
  static constexpr Index width = InterfaceLaws::most_state;
  Real* rows;  // [row][width]
  Index* law;  // [row] number of the law whose history it is, or -1

  /// The history of a row for a law: its value, or the law's value for loose faces if the
  /// row has none of this law.
  template <template <class> class Law, Index number, class Ids, class T>
  CDEM_HD void load(const Ids& row, T* state) const {
    load_from<Law, number, 0>(row, state);
  }
  template <class Ids, class T>
  CDEM_HD void store(const Ids& row, const Ids& law_of_row, const T* state) const {
    for (Index k = 0; k < width; ++k)
      for_lanes(row, [&](Index lane, Index r) {
        rows[std::size_t(r) * width + k] = of_lane(state[k], lane);
      });
    for_lanes(row, [&](Index lane, Index r) { law[r] = of_lane(law_of_row, lane); });
  }

 private:
  template <template <class> class Law, Index number, Index k, class Ids, class T>
  CDEM_HD void load_from(const Ids& row, T* state) const {
    if constexpr (k < state_count<Law>) {
      constexpr Real loose = loose_value<Law, k>;
      const auto kept = [&](Index r) {
        return law[r] == number ? rows[std::size_t(r) * width + k] : loose;
      };
      state[k] = numbers_of(kept, row);
      load_from<Law, number, k + 1>(row, state);
    }
  }
};

/// The law of each lane's contact answers, with the history of row `from`; the history of row `to`
/// is written.
template <class Laws, class T, class Ids>
CDEM_HD inline JointAnswer<T> respond_with_history(const InterfaceTable& table,
                                                   const Ids& interface, const JointInput<T>& in,
                                                   const HistoryRows& before, const Ids& from,
                                                   const HistoryRows& after, const Ids& to) {
  T state[Laws::most_state + 1];
  for (T& number : state) number = T(0.0);
  if constexpr (Laws::most_state > 0) {
    if (table.has_state)
      Laws::for_each([&]<template <class> class Law, Index number>() {
        if (!table.has(number)) return;
        T own[Laws::most_state];
        before.load<Law, number>(from, own);
        const auto mine = table.has_law<number>(interface);
        for (Index k = 0; k < state_count<Law>; ++k) state[k] = select(mine, own[k], state[k]);
      });
  }
  const JointAnswer<T> answer = joint_laws<Laws>(table, interface).respond(in, state);
  if constexpr (Laws::most_state > 0) {
    if (table.has_state) after.store(to, table.law_of(interface), state);
  }
  return answer;
}

}  // namespace cdem
