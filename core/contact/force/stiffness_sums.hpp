// stiffness_sums.hpp - kernels that sum the stiffness which bonds and contacts put on nodes.
#pragma once

#include "core/base/parallel.hpp"
#include "core/contact/force/unloading.hpp"

namespace cdem {

/// Stiffness of a set of bonded pairs at its nodes, by corner rows.
struct PairStiffness {
  Index corner_first, corners, count;  // rows, those of a pair, and pairs
  Index points, stride;
  const Real *stiffness, *area;  // [2][pair], [pair]
  const Index* point_first;      // overlaps: [pair + 1]; else null
  const Real *point_area, *weights_a, *weights_b;

  CDEM_HD bool has(Index row) const {
    return row >= corner_first && row < corner_first + count * corners;
  }
  /// Call visit(stiffness) for all springs at a row, in the order of their points.
  template <class Visit>
  CDEM_HD void visit(Index row, const Visit& visit) const {
    const Index pair = (row - corner_first) / corners, k = (row - corner_first) % corners;
    const Real most = max_of(stiffness[pair], stiffness[std::size_t(stride) + pair]);
    if (!point_first) return visit(most * area[pair] / points);
    const Real* const weights = k < 4 ? weights_a : weights_b;
    for (Index c = point_first[pair]; c < point_first[pair + 1]; ++c)
      visit(most * point_area[c] * abs_of(weights[4 * std::size_t(c) + k % 4]));
  }
};

/// Stiffness of the live bonds of a node.
struct SumBondStiffness {
  PairStiffness sets[3];
  const Index *corner_first, *corner;  // [node + 1] live corner rows, see LiveCorners
  Real* sum;

  CDEM_HD void operator()(One node) const {
    Real all = 0;
    for (Index c = corner_first[node.i]; c < corner_first[node.i + 1]; ++c) {
      const Index row = corner[c] < 0 ? ~corner[c] : corner[c];
      for (const PairStiffness& set : sets)
        if (set.has(row)) set.visit(row, [&](Real k) { all += k; });
    }
    sum[node.i] = all;
  }
};

/// Mark the faces on lists, and find the stiffest contact that each may have:
/// `pairs.visit(item, act)` calls act for pairs of a mother and a face.
template <class Pairs>
struct MarkListedFaces {
  Pairs pairs;
  ContactLaws laws;
  FaceGeometry geometry;
  bool alone;      // see raise_to
  Flag* listed;    // [exposed] initially 0
  Real* stiffest;  // [exposed] initially 0  [N/m]

  CDEM_HD void operator()(One item) const {
    pairs.visit(item, [&](const auto& of) {
      const Real one = stiffness(of.mother, of.face);
      learn(of.mother, one);
      learn(of.face, one);
    });
  }

 private:
  CDEM_HD void learn(Index face, Real one) const {
    set(listed[face]);
    raise_to(stiffest[face], one, alone);
  }
  CDEM_HD Real stiffness(Index x, Index y) const {
    const Index interface = laws.between(geometry, x, y);
    const auto spring = laws.spring(geometry, interface, x, y);
    const Real most = HystereticUnloading<Real>::of(laws, interface).stiffness(spring);
    // the rotation springs of four vertices, see UpdateRollingCouples
    const bool rolls = laws.interfaces.interfaces[interface].rolling_resistance > 0;
    return rolls ? most + 2 * spring.n() : most;
  }
};

/// Stiffness that the contacts of the faces of a node may have: either side's semi-springs, as much
/// again for semi-edges.
struct SumContactStiffness {
  const Index *contact_first, *contact_corner;  // [node + 1] slots of listed faces
  const Real* stiffest;                         // [exposed]  [N/m]
  Real* sum;

  CDEM_HD void operator()(One node) const {
    Real all = 0;
    for (Index c = contact_first[node.i]; c < contact_first[node.i + 1]; ++c)
      all += 2 * stiffest[contact_corner[c] / 4];
    sum[node.i] = all;
  }
};

}  // namespace cdem
