// views.hpp - what the kernels of contact forces see of the interfaces.
#pragma once

#include <algorithm>

#include "core/contact/force/contact_laws.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/interfaces/history.hpp"
#include "core/model/interface_table.hpp"
#include "core/model/state.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

inline ContactLaws contact_laws(const Model& m, const State& s) {
  return {.faces = face_interfaces(m),
          .interfaces = interface_table(m),
          .damping_ratio = m.contact_damping,
          .node_mass = lumped_masses(m, s).data()};
}

/// Does any interface ask for restitution, or close by a curve?
inline bool any_hysteretic(const Model& m) {
  const Transfer transfer;
  const auto all = on_host(m.interfaces);
  return interface_table(m).curved != 0 ||
         std::any_of(all.begin(), all.end(), [](const Interface& i) { return i.is_hysteretic(); });
}

/// Does any interface resist rolling?
inline bool any_resists_rolling(const Model& m) {
  const Transfer transfer;
  const auto all = on_host(m.interfaces);
  return std::any_of(all.begin(), all.end(),
                     [](const Interface& i) { return i.rolling_resistance > 0; });
}

inline HistoryRows history_rows(HistoryColumns& h) { return {h.rows.data(), h.law.data()}; }

}  // namespace cdem
