// contact_matrix.hpp - stiffness of one contact that is pressed: its springs, as if nothing slips.
#pragma once

#include "core/contact/force/contact_laws.hpp"
#include "core/contact/geometry/edge.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/records/rules.hpp"
#include "core/rest/item_matrix.hpp"

namespace cdem {

/// Contacts of exposed faces where the last step has found them.
struct PressedContacts {
  FaceColumns faces;
  FaceGeometry geometry;
  ContactLaws laws;
  SearchRules rules;
  SpringColumns springs;
  EdgeColumns edges;

  /// Of semi-spring `slot` (4 * exposed face + vertex); without nodes where it is not pressed.
  ItemMatrix spring_matrix(Index slot) const {
    const Index m = slot / 4, target = springs.target[slot];
    const Real* row = springs.reaction + 8 * std::size_t(slot);
    if (target < 0 || !(row[3] > 0)) return ItemMatrix(0);
    const ExposedRow &own = geometry.table[m], &other = geometry.table[target];
    ItemMatrix k(own.count() + other.count());
    Real weight[ItemMatrix::most];
    const Real action = max_of(rules.action, springs.rim_action[slot]);
    for (Index a = 0; a < own.count(); ++a) {
      k.node[a] = own.corner[a];
      weight[a] = action / Real(own.count()) + (a == slot % 4 ? 1 - action : 0);
    }
    for (Index a = 0; a < other.count(); ++a) {
      k.node[own.count() + a] = other.corner[a];
      weight[own.count() + a] = -row[4 + a];
    }
    add(k, weight, geometry.normal(target), row[3], m, target);
    return k;
  }

  /// Of a contact of semi-edges.
  ItemMatrix edge_matrix(Index place) const {
    const Real* row = edges.reaction + 8 * std::size_t(place);
    if (!(row[3] > 0)) return ItemMatrix(0);
    const EdgeContact c = EdgeContact::at(edges.contact, place);
    const Index m = c.mother / 4, side = c.mother % 4;
    const Index t0 = faces.edge_nodes[2 * c.edge], t1 = faces.edge_nodes[2 * c.edge + 1];
    const ExposedRow& target = geometry.table[c.face];
    Index start = 0;  // vertex of the target face at which its side begins
    while (start < 3 && !(of_side(target, start, t0, t1))) ++start;
    ItemMatrix k(4);
    k.node[0] = geometry.table[m].corner[side];
    k.node[1] = geometry.table[m].end(side);
    k.node[2] = target.corner[start];
    k.node[3] = target.end(start);
    const Real weight[4] = {1 - row[4], row[4], row[5] - 1, -row[5]};
    const InMotion& x = faces.nodes;
    const Vec3<Real> out = geometry.normal(c.face) - geometry.normal(m);
    const Vec3<Real> n = edge_normal(x.position(k.node[1]) - x.position(k.node[0]),
                                     x.position(t1) - x.position(t0), out);
    add(k, weight, n, row[3], m, c.face);
    return k;
  }

 private:
  static bool of_side(const ExposedRow& face, Index k, Index t0, Index t1) {
    const Index a = face.corner[k], b = face.end(k);
    return (a == t0 && b == t1) || (a == t1 && b == t0);
  }
  /// Springs of which the stiffer one has this stiffness  [N/m].
  void add(ItemMatrix& k, const Real* weight, const Vec3<Real>& n, Real largest, Index m,
           Index target) const {
    const auto interface = laws.between(geometry, m, target);
    const ContactSpring<Real> spring = laws.spring(geometry, interface, m, target);
    const Real scale = largest / max_of(spring.n(), spring.s());
    k.add_spring(weight, n, scale * spring.n(), scale * spring.s());
  }
};

}  // namespace cdem
