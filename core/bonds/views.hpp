// views.hpp - what the kernels of bonds see of model and state.
#pragma once

#include "core/bonds/bonded_pairs.hpp"
#include "core/model/interface_table.hpp"
#include "core/model/state.hpp"

namespace cdem {

inline PairColumns pair_columns(const Model& m, const PairSet& p, PairState& s) {
  const auto in = [&](const Column<Real>& c) { return InTable{c.data(), p.stride}; };
  const auto inout = [&](Column<Real>& c) { return InOutTable{c.data(), p.stride}; };
  const auto point = [&](Column<Real>& c) { return InOutTable{c.data(), p.point_stride}; };
  return {.interface = {p.interface.data(), p.stride},
          .area = in(p.area),
          .live = in(s.live),
          .stiffness = in(p.stiffness),
          .interfaces = interface_table(m),
          .bond = point(s.bond),
          .slip1 = point(s.slip1),
          .slip2 = point(s.slip2),
          .history = point(s.history),
          .broken_tension = inout(s.broken_tension),
          .broken_shear = inout(s.broken_shear),
          .jump = inout(s.jump),
          .jump_at_break = inout(s.jump_at_break),
          .stored = inout(s.stored),
          .fracture = inout(s.fracture),
          .friction = inout(s.friction)};
}

}  // namespace cdem
