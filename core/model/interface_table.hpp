// interface_table.hpp - the interfaces of a model, as kernels see them.
#pragma once

#include <algorithm>

#include "core/interfaces/laws.hpp"
#include "core/model/model.hpp"

namespace cdem {

/// Look at the interfaces once they are given or changed: no step then has to.
inline void note_interfaces(Model& m) {
  const auto all = on_host(m.interfaces);
  const auto parameters = on_host(m.interface_parameters);
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i].asks_area = asks_area(all[i].law, parameters.data() + i * parameter_row);
  const auto any = [&](auto&& has) { return std::any_of(all.begin(), all.end(), has); };
  const InterfaceTable table = table_of(all.data(), all.size(), nullptr);
  m.interface_traits = {
      .laws = table.laws,
      .curved = table.curved,
      .has_state = table.has_state,
      .hysteretic = table.curved != 0 || any([](const Interface& i) { return i.is_hysteretic(); }),
      .rolls = any([](const Interface& i) { return i.rolling_resistance > 0; }),
      .ask_area = any([](const Interface& i) { return i.asks_area; })};
}

inline InterfaceTable interface_table(const Model& m) {
  const InterfaceTraits& t = m.interface_traits;
  return {m.interfaces.data(), m.interface_parameters.data(), t.laws, t.curved, t.has_state};
}

}  // namespace cdem
