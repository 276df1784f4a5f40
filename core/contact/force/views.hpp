// views.hpp - what the kernels of contact forces see of the interfaces.
#pragma once

#include "core/contact/force/contact_laws.hpp"
#include "core/interfaces/history.hpp"
#include "core/model/interface_table.hpp"
#include "core/model/state.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

inline ContactLaws contact_laws(const Model& m, const State& s) {
  return {.interface_of = m.interface_of.data(),
          .interfaces = interface_table(m),
          .class_count = m.class_count,
          .damping_ratio = m.contact_damping,
          .node_mass = lumped_masses(m, s).data()};
}

inline HistoryRows history_rows(HistoryColumns& h) { return {h.rows.data(), h.law.data()}; }

}  // namespace cdem
