// list_exposed.hpp - kernel that makes the table of exposed faces.
#pragma once

#include "core/base/lanes.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// The row of an exposed face.
struct ListExposed {
  const Index *exposed_face, *face_exposed;
  const Index* across;  // [exposed][4] face beyond a side, or -1
  const Index *face_nodes, *face_interface_class;
  const Real *face_reach, *face_area, *face_stiffness;
  ExposedRow* rows;

  CDEM_HD void operator()(One x) const {
    const Index face = exposed_face[x.i];
    const Index* const nodes = face_nodes + 4 * std::size_t(face);
    ExposedRow row;
    for (Index k = 0; k < 4; ++k) {
      const Index beyond = across[4 * std::size_t(x.i) + k];
      row.corner[k] = nodes[k] < 0 ? nodes[2] : nodes[k];
      row.beside[k] = beyond < 0 ? -1 : face_exposed[beyond];
    }
    row.reach = face_reach[face];
    row.area = face_area[face] / row.count();
    row.stiffness = face_stiffness[face];
    row.interface_class = face_interface_class[face];
    rows[x.i] = row;
  }
};

/// Which exposed faces are own, of a rank, and their slots.
struct OwnExposed {
  const Index* exposed_face;
  const Flag* own_face;
  Flag *own, *own_slots;
  CDEM_HD void operator()(One x) const {
    const Flag is_own = own_face[exposed_face[x.i]];
    own[x.i] = is_own;
    for (Index k = 0; k < 4; ++k) own_slots[4 * std::size_t(x.i) + k] = is_own;
  }
};

}  // namespace cdem
