// contact_area.hpp - the area that faces share, given to their contacts.
//
// Contacts have the areas of Eqs. 4-5 for their stiffness: shares of faces, which do not sum to the
// area that is in contact where the meshes of both sides differ. Laws that ask for an area get the
// true one: the overlap of each two faces, half for either, given to the contacts that a face has
// by their stiffness. Stiffness stays.
#pragma once

#include "core/contact/force/accumulate.hpp"
#include "core/contact/force/contact_laws.hpp"
#include "core/contact/geometry/face_overlap.hpp"

namespace cdem {

/// The contacts of an exposed face whose law asks for an area: a row of 4.
struct TouchingFace {
  Real stiffness;  // their sum; nearly zero for unpressed ones  [N/m]
  Real risen;      // highest of their stress-free gaps  [m]
  Real pressed;    // 1 where one of them was pressed one step ago

  CDEM_HD static TouchingFace at(const Real* rows, Index exposed) {
    const Real* r = rows + 4 * std::size_t(exposed);
    return {r[0], r[1], r[2]};
  }
};

/// Sum the stiffness of the contacts of each exposed face, as mother or as target.
struct SumTouching {
  ContactsOf contacts;
  ContactsByTarget acting;
  FaceGeometry geometry;
  ContactLaws laws;
  const Real* edge_state_before;
  Real* rows;  // of TouchingFace

  static constexpr Real of_open = 1e-6;  // part of its stiffness that a contact without force has

  CDEM_HD void operator()(One m) const {
    TouchingFace sum{};
    for (Index slot = 4 * m.i; slot < 4 * m.i + 4; ++slot)
      if (contacts.springs.target[slot] >= 0) add(sum, slot);
    for (Index c = contacts.edges.first[m.i]; c < contacts.edges.first[m.i + 1]; ++c)
      add(sum, 4 * contacts.exposed + c);
    for (Index k = acting.first[m.i]; k < acting.first[m.i + 1]; ++k) add(sum, acting.contact[k]);
    Real* row = rows + 4 * std::size_t(m.i);
    row[0] = sum.stiffness, row[1] = sum.risen, row[2] = sum.pressed;
  }

 private:
  CDEM_HD void add(TouchingFace& sum, Index contact) const {
    const bool is_edge = contact >= 4 * contacts.exposed;
    Index mother = contact / 4, target;
    ContactState held = ContactState::none();
    if (is_edge) {
      const EdgeContact edge =
          EdgeContact::at(contacts.edges.contact, contact - 4 * contacts.exposed);
      mother = edge.mother / 4;
      target = edge.face;
      if (edge.before >= 0) held = ContactState::at(edge_state_before, edge.before);
    } else {
      target = contacts.springs.target[contact];
      if (contacts.springs.target_before[contact] >= 0)
        held = ContactState::at(contacts.springs.state, contact);
    }
    const Index interface = laws.between(geometry, mother, target);
    if (!laws.interfaces.interfaces[interface].asks_area ||
        !laws.have_area(geometry, mother, target))
      return;
    const bool pressed = held.penetration > 0;
    const Real part = (is_edge ? 1.0 : 0.5) * (pressed ? 1.0 : of_open);
    sum.stiffness += part * laws.spring(geometry, interface, mother, target).n();
    sum.risen = max_of(sum.risen, held.stress_free_gap);
    if (pressed) sum.pressed = 1;
  }
};

/// Give each exposed face the area that it has in common with others, over the stiffness of its
/// contacts. Where only one of two faces has pressed contacts it gets all.
struct ShareAreas {
  FaceColumns faces;
  FaceGeometry geometry;
  ContactLaws laws;
  SearchRules rules;
  const Index* exposed_face;
  const Index* facing_first;  // [exposed + 1]
  const Index* facing;        // exposed faces that may touch it
  const Real* touching;       // rows of TouchingFace
  Real* area_per_stiffness;   // [exposed]  [m3/N]

  /// Faces are in contact where they are nearer than this part of an indentation.
  static constexpr Real near_part = 0.5;

  CDEM_HD void operator()(One m) const {
    const TouchingFace own = TouchingFace::at(touching, m.i);
    area_per_stiffness[m.i] = 0;
    if (!(own.stiffness > 0)) return;
    Real area = 0;
    for (Index k = facing_first[m.i]; k < facing_first[m.i + 1]; ++k) {
      const Index t = facing[k];
      const Index interface = laws.between(geometry, m.i, t);
      if (!laws.interfaces.interfaces[interface].asks_area) continue;
      const TouchingFace other = TouchingFace::at(touching, t);
      const bool shares = other.stiffness > 0 && !(other.pressed < own.pressed);
      if (other.pressed > own.pressed) continue;
      area += (shares ? 0.5 : 1.0) * overlap(m.i, t, max_of(own.risen, other.risen));
    }
    area_per_stiffness[m.i] = area / own.stiffness;
  }

 private:
  /// Both faces get the same bits.
  CDEM_HD Real overlap(Index m, Index t, Real risen) const {
    const bool in_order = exposed_face[m] < exposed_face[t];
    const Index a = in_order ? m : t, b = in_order ? t : m;
    const Real reach = geometry.table[a].reach + geometry.table[b].reach;
    const Vec3<Real> apart = geometry.center(a) - geometry.center(b);
    if (dot(apart, apart) > reach * reach) return 0;
    if (!laws.have_area(geometry, a, b)) return 0;
    const Real length = min_of(geometry.length(a), geometry.length(b));
    const Real height =
        min_of(faces.face_height[exposed_face[a]], faces.face_height[exposed_face[b]]);
    return FaceOverlap(faces.shape(geometry.vertices(a)), faces.shape(geometry.vertices(b)))
        .area(-min_of(rules.depth * length, 0.5 * height),
              near_part * rules.indentation * length + max_of(risen, 0.0));
  }
};

}  // namespace cdem
