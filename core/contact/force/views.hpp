// views.hpp - what the kernels of contact forces see of the interfaces.
#pragma once

#include "core/contact/force/contact_laws.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

inline ContactLaws contact_laws(const Model& m, const State& s) {
  return {m.interface_of.data(), m.interfaces.data(), m.class_count, m.contact_damping,
          lumped_masses(m, s).data()};
}

}  // namespace cdem
