// interface_table.hpp - the interfaces of a model, as kernels see them.
#pragma once

#include "core/base/device.hpp"
#include "core/interfaces/laws.hpp"
#include "core/model/model.hpp"

namespace cdem {

inline InterfaceTable interface_table(const Model& m) {
  const Transfer transfer;
  return table_of(on_host(m.interfaces).data(), m.interfaces.size(), m.interface_parameters.data());
}

}  // namespace cdem
