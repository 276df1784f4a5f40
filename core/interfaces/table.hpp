// table.hpp - the interfaces of a model, and which laws they have.
#pragma once

#include "core/base/views.hpp"
#include "core/records/interface.hpp"

namespace cdem {

/// The interfaces of a model and the parameters of their laws.
struct InterfaceTable {
  const Interface* interfaces;
  const Real* parameters;  // [interface][parameter_row]
  unsigned laws;           // laws of all interfaces, as bits
  unsigned curved;         // laws with a closure curve among them, as bits
  bool has_state;          // has one of them state?

  CDEM_HD bool has(Index law) const { return (laws >> law & 1) != 0; }
  /// Are all brittle, the first law of the list?
  CDEM_HD bool is_brittle() const { return laws == 1; }
  /// Number of the law of an interface, or of one a lane.
  template <class Ids>
  CDEM_HD Ids law_of(const Ids& interface) const {
    return indices_of([&](Index i) { return interfaces[i].law; }, interface);
  }
  /// The lanes whose joints close by a curve.
  template <class Ids>
  CDEM_HD Truth<Number<Ids>> closes_by_curve(const Ids& interface) const {
    if (curved == 0) return Number<Ids>(0.0) > Number<Ids>(0.5);
    const auto own = [&](Index i) { return Real(curved >> interfaces[i].law & 1); };
    return numbers_of(own, interface) > Number<Ids>(0.5);
  }
  /// The lanes that have law `number`.
  template <Index number, class Ids>
  CDEM_HD Truth<Number<Ids>> has_law(const Ids& interface) const {
    if (laws == 1u << number) return Number<Ids>(1.0) > Number<Ids>(0.5);
    const auto own = [&](Index i) { return Real(interfaces[i].law == number); };
    return numbers_of(own, interface) > Number<Ids>(0.5);
  }
};

}  // namespace cdem
