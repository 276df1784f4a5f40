// face_interfaces.hpp - which interface two exposed faces have.
#pragma once

#include "core/base/views.hpp"
#include "core/records/contact_records.hpp"
#include "core/records/interface.hpp"

namespace cdem {

/// Interfaces by pair of classes of faces.
struct FaceInterfaces {
  const Index* interface_of;  // [class_m * class_count + class_t]
  const Interface* interfaces;
  Index class_count;

  /// The interface between two exposed faces, or between one and another a lane.
  template <class Ids>
  CDEM_HD auto between(const ExposedRow* faces, const Ids& m, const Ids& t) const {
    return indices_of(
        [&](Index a, Index b) {
          return interface_of[faces[a].interface_class * class_count + faces[b].interface_class];
        },
        m, t);
  }
  /// Share of the energy of loading that contacts of an interface give back, normal and shear.
  template <class Ids>
  CDEM_HD auto returned_n(const Ids& interface) const {
    return numbers_of([&](Index i) { return interfaces[i].returned_n; }, interface);
  }
  template <class Ids>
  CDEM_HD auto returned_s(const Ids& interface) const {
    return numbers_of([&](Index i) { return interfaces[i].returned_s; }, interface);
  }
};

}  // namespace cdem
