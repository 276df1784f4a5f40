// views.hpp - what the kernels of bonds see of model and state.
#pragma once

#include "core/bonds/bonded_pairs.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline PairColumns pair_columns(const Model& m, const PairSet& p, PairState& s) {
  const auto in = [&](const Column<Real>& c) { return InTable{c.data(), p.stride}; };
  const auto inout = [&](Column<Real>& c) { return InOutTable{c.data(), p.stride}; };
  const auto point = [&](Column<Real>& c) { return InOutTable{c.data(), p.point_stride}; };
  return {{p.interface.data(), p.stride},
          in(p.area),
          in(s.live),
          in(p.stiffness),
          m.cohesion.data(),
          m.tensile_strength.data(),
          m.tan_friction.data(),
          point(s.bond),
          point(s.slip1),
          point(s.slip2),
          inout(s.broken_tension),
          inout(s.broken_shear),
          inout(s.jump),
          inout(s.jump_at_break),
          inout(s.stored),
          inout(s.fracture),
          inout(s.friction)};
}

}  // namespace cdem
