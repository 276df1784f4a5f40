// views.hpp - the view of interfaces for kernels of contact forces.
#pragma once

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
          .node_mass = lumped_masses(m, s).data(),
          .area_per_stiffness =
              m.interface_traits.ask_area ? s.contact_areas.per_stiffness.data() : nullptr};
}

inline HistoryRows history_rows(HistoryColumns& h) { return {h.rows.data(), h.law.data()}; }

}  // namespace cdem
