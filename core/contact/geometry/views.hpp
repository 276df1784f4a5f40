// views.hpp - the kernels' view of exterior faces.
#pragma once

#include "core/contact/geometry/face_geometry.hpp"
#include "core/contact/geometry/face_interfaces.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline FaceColumns face_columns(const Model& m, const State& s) {
  return {.nodes = {s.nodes.motion.data()},
          .face_nodes = m.face_nodes.data(),
          .face_edges = m.face_edges.data(),
          .face_length = m.face_length.data(),
          .face_height = m.face_height.data(),
          .edge_nodes = m.edge_nodes.data(),
          .beyond = s.search.across.data(),
          .edge_star_first = s.search.edge_star_first.data(),
          .edge_star = s.search.edge_star.data(),
          .bonded_node = s.nodes.bonded_node.data(),
          .body = s.nodes.body.data(),
          .node_place = m.node_place.data(),
          .face_exposed = s.search.face_exposed.data(),
          .dt = s.dt_last};
}

inline FaceGeometry face_geometry(const State& s) {
  return {s.face_geometry.data(), s.search.exposed.data()};
}

inline FaceInterfaces face_interfaces(const Model& m) {
  return {m.interface_of.data(), m.interfaces.data(), m.class_count};
}

}  // namespace cdem
