// fast_weakening.cpp - see fast_weakening.hpp.
#include "core/diagnostics/fast_weakening.hpp"

#include <algorithm>
#include <vector>

#include "core/contact/force/mother_point.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/geometry/views.hpp"

namespace cdem {

namespace {

/// How fast the friction of each interface falls with the speed, at most  [s/m].
std::vector<Real> falls_of(const Model& m) {
  const auto interfaces = on_host(m.interfaces);
  const auto parameters = on_host(m.interface_parameters);
  std::vector<Real> falls(interfaces.size());
  for (std::size_t i = 0; i < falls.size(); ++i)
    InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
      if constexpr (requires { &Law<Real>::friction_fall; })
        if (interfaces[i].law == number)
          falls[i] = Law<Real>::friction_fall(parameters.data() + i * parameter_row);
    });
  return falls;
}

/// The worst contacts so far, by interface.
struct Worst {
  std::vector<FastWeakening> of;

  void meet(Index interface, Real ratio, const Vec3<Real>& place) {
    FastWeakening& worst = of[interface];
    if (ratio > worst.ratio) worst = {interface, ratio, place};
  }
};

void look_at_springs(const Model& m, State& s, const std::vector<Real>& falls, Worst& worst) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const FaceGeometry geometry = on_host(face_geometry(s));
  const ContactLaws laws = on_host(contact_laws(m, s));
  const auto target = on_host(s.springs.target);
  const auto rim_action = on_host(s.springs.rim_action);
  const auto reaction = on_host(s.springs.reaction), state = on_host(s.springs.state);
  for (Index x = 0; x < Index(s.search.exposed_face.size()); ++x)
    for (Index slot = 4 * x; slot < 4 * x + 4; ++slot) {
      const Index y = target[slot];
      const Index interface = y < 0 ? 0 : laws.between(geometry, x, y);
      if (y < 0 || !(falls[interface] > 0)) continue;
      const auto mother = MotherPoint<Real>::at(faces, geometry, m.rules, rim_action.data(),
                                                laws.node_mass, x, slot);
      const Real* weight = reaction.data() + std::size_t(slot) * 8 + 4;
      const FaceVertices<Index> corners = geometry.vertices(y);
      Real inverse_mass = mother.inverse_mass;
      for (Index j = 0; j < 4; ++j)
        inverse_mass += weight[j] * weight[j] / laws.node_mass[corners.node[j]];
      const Real force = ContactState::at(state.data(), slot).force_n;
      worst.meet(interface, falls[interface] * force * faces.dt * inverse_mass, mother.x);
    }
}

/// With the lighter end of either edge: the other one takes a part.
void look_at_edges(const Model& m, State& s, const std::vector<Real>& falls, Worst& worst) {
  const FaceColumns faces = on_host(face_columns(m, s));
  const FaceGeometry geometry = on_host(face_geometry(s));
  const ContactLaws laws = on_host(contact_laws(m, s));
  const auto contacts = on_host(s.edges.contact);
  const auto state = on_host(s.edges.state);
  for (std::size_t c = 0; c < contacts.size() / 4; ++c) {
    const EdgeContact contact = EdgeContact::at(contacts.data(), c);
    const Index x = contact.mother / 4, side = contact.mother % 4;
    const Index interface = laws.between(geometry, x, contact.face);
    if (!(falls[interface] > 0)) continue;
    const Index ends[2][2] = {
        {geometry.table[x].corner[side], geometry.table[x].end(side)},
        {faces.edge_nodes[2 * contact.edge], faces.edge_nodes[2 * contact.edge + 1]}};
    Real inverse_mass = 0;
    for (const auto& end : ends)
      inverse_mass += 1 / std::min(laws.node_mass[end[0]], laws.node_mass[end[1]]);
    const Real force = ContactState::at(state.data(), c).force_n;
    worst.meet(interface, falls[interface] * force * faces.dt * inverse_mass,
               faces.nodes.position(ends[0][0]));
  }
}

}  // namespace

std::vector<FastWeakening> fast_weakenings(const Model& m, State& s) {
  const std::vector<Real> falls = falls_of(m);
  if (std::none_of(falls.begin(), falls.end(), [](Real fall) { return fall > 0; })) return {};
  Worst worst{std::vector<FastWeakening>(falls.size(), {-1, 0, {0, 0, 0}})};
  look_at_springs(m, s, falls, worst);
  look_at_edges(m, s, falls, worst);
  std::erase_if(worst.of, [](const FastWeakening& w) { return w.interface < 0; });
  return worst.of;
}

}  // namespace cdem
