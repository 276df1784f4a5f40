// views.hpp - what the kernels of elements see of model and state.
#pragma once

#include "core/elements/shapes.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

template <class Shape>
ElementColumns<Shape> element_columns(const Model& m, const State& s, const ElementSet& e) {
  return {{s.nodes.motion.data()},       {e.nodes.data(), e.stride},
          {e.gradient.data(), e.stride}, {e.volume.data(), e.stride},
          {e.material.data(), e.stride}, {m.material_lambda.data(), m.material_mu.data()},
          {e.hourglass.data(), e.stride}};
}

}  // namespace cdem
