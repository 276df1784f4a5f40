// views.hpp - what kernels see of exterior faces.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline FaceColumns face_columns(const Model& m, const State& s) {
  return {{s.nodes.motion.data()},
          m.face_nodes.data(),
          m.face_edges.data(),
          m.face_length.data(),
          m.face_height.data(),
          m.edge_nodes.data(),
          s.search.across.data(),
          s.search.edge_star_first.data(),
          s.search.edge_star.data(),
          s.nodes.bonded_node.data(),
          m.node_place.data(),
          s.search.face_exposed.data(),
          s.dt_last};
}

inline FaceGeometry face_geometry(const State& s) {
  return {s.face_geometry.data(), s.search.exposed.data()};
}

}  // namespace cdem
