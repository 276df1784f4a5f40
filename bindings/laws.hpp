// laws.hpp - declarations of the laws, and the interfaces of a model, for Python.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings/arrays.hpp"
#include "core/interfaces/draws.hpp"
#include "core/interfaces/laws.hpp"
#include "core/materials/laws.hpp"
#include "core/model/init_state.hpp"
#include "core/model/interface_table.hpp"
#include "core/surface/laws.hpp"

namespace cdem {

/// Numbers of a law's parameters in the order of its declaration, from a dict by name.
template <class Law>
std::vector<Real> parameters_of(const nb::dict& values) {
  std::vector<Real> row;
  for (const Parameter& p : Law::parameters) row.push_back(nb::cast<Real>(values[p.name]));
  return row;
}

/// Numbers for kernels: made by the law from its parameters, or the parameters themselves.
template <class Law>
std::vector<Real> numbers_of_law(const nb::dict& values) {
  std::vector<Real> row = parameters_of<Law>(values);
  if constexpr (requires { &Law::prepare; }) {
    const auto numbers = Law::prepare(row.data());
    row.assign(numbers.begin(), numbers.end());
  }
  return row;
}

/// Call act.template operator()<Law, number>() for the law of this name.
template <class Laws, class Act>
void with_law(const std::string& name, const Act& act) {
  bool found = false;
  Laws::for_each([&]<template <class> class Law, Index number>() {
    if (name != Law<Real>::text.name) return;
    found = true;
    act.template operator()<Law, number>();
  });
  if (!found) throw nb::value_error("unknown law");
}

/// Why parameters of a law, as the core takes them, contradict each other, or an empty text.
template <class Laws>
std::string contradiction(const std::string& law, const nb::dict& values) {
  std::string why;
  with_law<Laws>(law, [&]<template <class> class Law, Index>() {
    const char* text = Law<Real>::contradiction(parameters_of<Law<Real>>(values).data());
    if (text) why = text;
  });
  return why;
}

/// Pieces of a table of (slip, value) for one falling number.
inline void add_pieces(std::vector<Real>& row, Index number, const nb::list& table) {
  using Entry = std::tuple<Real, Real>;
  if (nb::len(table) > fall_pieces + 1) throw nb::value_error("a table of too many rows");
  for (std::size_t s = 0; s + 1 < nb::len(table); ++s) {
    const auto [begin, before] = nb::cast<Entry>(table[s]);
    const auto [end, after] = nb::cast<Entry>(table[s + 1]);
    Real* piece = row.data() + law_numbers + 1 + (number * fall_pieces + Index(s)) * piece_numbers;
    piece[0] = begin, piece[1] = end - begin, piece[2] = (after - before) / (end - begin);
  }
}

/// The row of numbers that kernels read of a material: its parameters as the core takes them, and
/// tables of (slip, value) by the name of the softening parameter.
inline std::vector<Real> material_numbers(const std::string& law, const nb::dict& values,
                                          const nb::dict& softening) {
  std::vector<Real> row(material_row);
  for (Index piece = 0; piece < falling_numbers * fall_pieces; ++piece)
    row[law_numbers + 1 + piece * piece_numbers] = unlimited;
  row[law_numbers] = nb::len(softening) > 0;
  with_law<BlockLaws>(law, [&]<template <class> class Law, Index>() {
    const auto numbers = numbers_of_law<Law<Real>>(values);
    std::copy(numbers.begin(), numbers.end(), row.begin());
    if constexpr (numbers_that_fall<Law> > 0)
      for (Index k = 0; k < numbers_that_fall<Law>; ++k)
        if (softening.contains(Law<Real>::softening[k]))
          add_pieces(row, k, nb::cast<nb::list>(softening[Law<Real>::softening[k]]));
  });
  return row;
}

/// Number of a surface law, and the row of numbers that kernels read of an entry.
inline std::pair<Index, std::vector<Real>> surface_numbers(const std::string& law,
                                                           const nb::dict& values) {
  std::pair<Index, std::vector<Real>> of{0, std::vector<Real>(surface_row)};
  with_law<SurfaceLaws>(law, [&]<template <class> class Law, Index number>() {
    const auto numbers = numbers_of_law<Law<Real>>(values);
    std::copy(numbers.begin(), numbers.end(), of.second.begin());
    of.first = number;
  });
  return of;
}

/// How fast the strength of an interface law falls, normal and in shear  [Pa/m].
inline std::pair<Real, Real> steepest_fall(const std::string& law, const nb::dict& values) {
  std::pair<Real, Real> fall{0, 0};
  with_law<InterfaceLaws>(law, [&]<template <class> class Law, Index>() {
    if constexpr (requires { &Law<Real>::steepest_fall; }) {
      const auto [n, s] = Law<Real>::steepest_fall(parameters_of<Law<Real>>(values).data());
      fall = {n, s};
    }
  });
  return fall;
}

/// The pressure from which on joints of an interface law are as stiff as k_n [Pa/m], which is zero
/// where they are so from the start  [Pa].
inline Real curve_end(const std::string& law, const nb::dict& values, Real stiffness_n) {
  Real pressure = 0;
  with_law<InterfaceLaws>(law, [&]<template <class> class Law, Index number>() {
    if constexpr (is_curved<Law>)
      pressure = Law<Real>::curve_end(numbers_of_law<Law<Real>>(values).data(), stiffness_n);
  });
  return pressure;
}

/// Factors on the strength of pairs, from rows of two faces.
inline nb::ndarray<nb::numpy, Real> weibull_factors(Array<Index> faces, std::uint64_t seed,
                                                    Real shape, Real mean) {
  std::vector<Real> factors;
  for (std::size_t i = 0; i + 1 < faces.size(); i += 2)
    factors.push_back(weibull_factor(seed, faces.data()[i], faces.data()[i + 1], shape, mean));
  return array_of(std::move(factors));
}

/// Declarations of the laws of a list.
template <class Laws>
nb::list declarations() {
  nb::list laws;
  Laws::for_each([&]<template <class> class Law, Index>() {
    nb::dict law;
    law["name"] = Law<Real>::text.name;
    law["meaning"] = Law<Real>::text.meaning;
    law["flows"] = false;
    law["curved"] = law["absorbs"] = false;
    if constexpr (requires { Law<Real>::impedance(nullptr, Impedance{}); }) law["absorbs"] = true;
    if constexpr (requires { Law<Real>::curve_end(nullptr, Real(0)); }) law["curved"] = true;
    if constexpr (requires { Law<Real>::inelastic; }) law["flows"] = Law<Real>::inelastic;
    nb::list parameters, state;
    for (const Parameter& p : Law<Real>::parameters) {
      nb::dict d;
      d["name"] = p.name, d["symbol"] = p.symbol;
      d["unit"] = p.unit, d["meaning"] = p.meaning;
      d["at_least"] = std::isfinite(p.at_least) ? nb::cast(p.at_least) : nb::none();
      d["below"] = std::isfinite(p.below) ? nb::cast(p.below) : nb::none();
      d["at_most"] = std::isfinite(p.at_most) ? nb::cast(p.at_most) : nb::none();
      d["default"] = std::isnan(p.otherwise) ? nb::none() : nb::cast(p.otherwise);
      d["like"] = p.like ? nb::cast(p.like) : nb::none();
      d["is_tangent"] = p.form == Form::tangent;
      d["is_half_tangent"] = p.form == Form::half_tangent;
      d["is_strength"] = p.is_strength;
      d["is_factor"] = p.is_factor;
      d["choices"] = p.choices ? p.choices : "";
      d["bonds"] = p.bonds;
      parameters.append(d);
    }
    for (const StateVariable& v : Law<Real>::state) {
      nb::dict d;
      d["name"] = v.name, d["unit"] = v.unit, d["meaning"] = v.meaning;
      state.append(d);
    }
    nb::list softening;
    if constexpr (requires { Law<Real>::softening; })
      for (const char* name : Law<Real>::softening) softening.append(name);
    law["softening"] = softening;
    law["parameters"] = parameters;
    law["state"] = state;
    laws.append(law);
  });
  return laws;
}

/// The interfaces of the model: law and its parameters, stiffness_n and stiffness_s of contacts as
/// (value, factor), whether that is of the sides in series, their restitution, normal and
/// tangential, and their rolling resistance.
inline void set_interfaces(Core& core, const nb::list& interfaces) {
  Model& m = core.model;
  constexpr std::size_t width = parameter_row;
  m.interfaces.resize(interfaces.size());
  m.interface_parameters.resize(width * interfaces.size());
  const auto rows = on_host(m.interfaces);
  const auto parameters = on_host(m.interface_parameters);
  Real lift = 0;
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const auto entry = nb::cast<nb::dict>(interfaces[i]);
    const auto stiffness = [&](const char* name) {
      return nb::cast<std::tuple<Real, Real>>(entry[name]);
    };
    Interface& interface = rows[i];
    interface.in_series = nb::cast<bool>(entry["in_series"]);
    std::tie(interface.stiffness_n_value, interface.stiffness_n_factor) = stiffness("stiffness_n");
    std::tie(interface.stiffness_s_value, interface.stiffness_s_factor) = stiffness("stiffness_s");
    interface.rolling_resistance = nb::cast<Real>(entry["rolling_resistance"]);
    const auto [e_n, e_t] = nb::cast<std::tuple<Real, Real>>(entry["restitution"]);
    interface.returned_n = e_n * e_n;
    interface.returned_s = e_t * e_t;
    const auto name = nb::cast<std::string>(entry["law"]);
    with_law<InterfaceLaws>(name, [&]<template <class> class Law, Index number>() {
      interface.law = number;
      const auto row = numbers_of_law<Law<Real>>(nb::cast<nb::dict>(entry["parameters"]));
      std::copy(row.begin(), row.end(), parameters.begin() + width * i);
      lift = std::max(lift, 2 * Law<Real>::rise_most(row.data()));
    });
  }
  note_interfaces(m);
  m.rules.lifted = m.initial_lift + lift;
  make_room_for_rises(m, core.state);
}

}  // namespace cdem
