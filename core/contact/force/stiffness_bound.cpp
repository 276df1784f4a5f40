// stiffness_bound.cpp - see stiffness_bound.hpp.
#include "core/contact/force/stiffness_bound.hpp"

#include "core/base/primitives.hpp"
#include "core/contact/force/stiffness_sums.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

PairStiffness stiffness_by_row(const PairSet& p) {
  return {.corner_first = p.corner_first,
          .corners = p.corners,
          .count = p.count,
          .points = p.points,
          .stride = p.stride,
          .stiffness = p.stiffness.data(),
          .area = p.area.data(),
          .point_first = conforms(p) ? nullptr : p.point_first.data(),
          .point_area = p.point_area.data(),
          .weights_a = p.weights_a.data(),
          .weights_b = p.weights_b.data()};
}

/// Modules add what their items have, after the bonds.
void add_modules(const Model& m, State& s) {
  Modules::for_each_of<Port::rows>([&]<class Module>() {
    const auto& given = given_of<Module>(m);
    if (given.count == 0) return;
    const auto is_active = activity(state_of<Module>(s));
    const auto for_each_stiffness = stiffness_of(m, given);
    const auto bonds = on_host(s.node_bonds);
    for (Index i = 0; i < given.count; ++i)
      if (is_active(i)) for_each_stiffness(i, [&](Index node, Real k) { bonds[node] += k; });
  });
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    if constexpr (requires { Module::stiffness_of(given_of<Module>(m)); }) {
      if (!Module::is_there(given_of<Module>(m))) return;
      const auto bonds = on_host(s.node_bonds);
      Module::stiffness_of(given_of<Module>(m))([&](Index node, Real k) { bonds[node] += k; });
    }
  });
}

}  // namespace

void sum_bond_stiffness(const Model& m, State& s) {
  s.node_bonds.renew(m.node_count);
  for_each_item({}, m.node_count,
                SumBondStiffness{.sets = {stiffness_by_row(m.triangles), stiffness_by_row(m.quads),
                                          stiffness_by_row(m.overlaps)},
                                 .corner_first = s.nodes.corner_first.data(),
                                 .corner = s.nodes.corner.data(),
                                 .sum = s.node_bonds.data()});
  add_modules(m, s);
}

void sum_contact_stiffness(const Model& m, State& s, const Column<Real>& stiffest) {
  s.node_potential.renew(m.node_count);
  for_each_item({}, m.node_count,
                SumContactStiffness{.contact_first = s.search.contact_first.data(),
                                    .contact_corner = s.search.contact_corner.data(),
                                    .stiffest = stiffest.data(),
                                    .sum = s.node_potential.data()});
}

}  // namespace cdem
