// pair_matrix.hpp - stiffness of one bonded pair: the springs of its points that bear.
#pragma once

#include "core/bonds/bonded_pairs.hpp"
#include "core/rest/item_matrix.hpp"

namespace cdem {

/// Does a point of a pair bear: is it intact, or pressed?
inline bool bears(Real bond, const Frame<Real>& frame, const Vec3<Real>& jump) {
  return bond > 0.5 || dot(frame.n, jump) < 0;
}

/// Of the points of a conforming pair that bear.
template <Index count>
ItemMatrix pair_matrix(const ConformingBonds<count>& bonds, One p) {
  ItemMatrix k(2 * count);
  for (Index a = 0; a < 2 * count; ++a) k.node[a] = bonds.pair_nodes.at(a, p);
  if (!bonds.pairs.are_live(p)) return k;
  Vec3<Real> jump[count];
  const Frame<Real> frame = bonds.gather_jumps(p, jump);
  const BondSpring<Real> spring = bonds.spring(p);
  for (Index q = 0; q < count; ++q) {
    if (!bears(bonds.pairs.bond.at(q, p), frame, jump[q])) continue;
    Real weight[2 * count];
    for (Index a = 0; a < count; ++a) {
      weight[count + a] = (a == q ? 1 - bonds.indentation : 0) + bonds.indentation / count;
      weight[a] = -weight[count + a];
    }
    k.add_spring(weight, frame.n, spring.area * spring.stiffness.n,
                 spring.area * spring.stiffness.s);
  }
  return k;
}

/// Of those of faces that overlap.
inline ItemMatrix pair_matrix(const OverlapBonds& bonds, One p) {
  const Index side[2] = {bonds.pair_faces[2 * p.i], bonds.pair_faces[2 * p.i + 1]};
  const Index corners[2] = {bonds.faces.vertex_count(side[0]), bonds.faces.vertex_count(side[1])};
  ItemMatrix k(corners[0] + corners[1]);
  for (Index a = 0; a < k.count; ++a)
    k.node[a] = a < corners[0] ? bonds.faces.vertex(side[0], a)
                               : bonds.faces.vertex(side[1], a - corners[0]);
  if (!bonds.pairs.are_live(p)) return k;
  const Frame<Real> frame = bonds.frame_of(side[0], side[1]);
  for (Index c = bonds.point_first[p.i]; c < bonds.point_first[p.i + 1]; ++c) {
    if (!bears(bonds.pairs.bond.at(0, One{c}), frame, bonds.jump_at(side[0], side[1], frame, c)))
      continue;
    const BondSpring<Real> spring = bonds.pairs.spring(p, bonds.point_area[c]);
    Real weight[ItemMatrix::most];
    for (Index a = 0; a < k.count; ++a)
      weight[a] =
          a < corners[0] ? -bonds.weights_a[4 * c + a] : bonds.weights_b[4 * c + a - corners[0]];
    k.add_spring(weight, frame.n, spring.area * spring.stiffness.n,
                 spring.area * spring.stiffness.s);
  }
  return k;
}

}  // namespace cdem
