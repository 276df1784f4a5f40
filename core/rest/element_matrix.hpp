// element_matrix.hpp - stiffness of one element: how its forces change where its nodes move a
// little.
#pragma once

#include "core/elements/corotational.hpp"
#include "core/rest/item_matrix.hpp"

namespace cdem {

/// Of an element whose rotation is held: sum over points of w J B^T R C R^T B.
template <class Shape>
ItemMatrix element_matrix(const ElementColumns<Shape>& c, One e) {
  ItemMatrix k(Shape::nodes);
  const ElasticConstants<Real> elastic = c.elastic(e);
  const PointStrains<Shape, FollowRotation, Real> now(c, e, false);
  for (Index b = 0; b < Shape::nodes; ++b) {
    k.node[b] = c.element_nodes.at(b, e);
    for (Index j = 0; j < 3; ++j) {
      const Vec3<Real> unit{j == 0 ? 1.0 : 0.0, j == 1 ? 1.0 : 0.0, j == 2 ? 1.0 : 0.0};
      Arms<Shape, Real> arms;
      for (Index a = 0; a < Shape::nodes; ++a)
        arms.a[a] = b == 0 ? -unit : (a == b ? unit : Vec3<Real>{0, 0, 0});
      Sym3<Real> strain[Shape::points];
      for (Index q = 0; q < Shape::points; ++q)
        strain[q] = symmetric(transpose(now.rotation[q]) * gradient_of<Shape>(c, e, q, arms));
      use_mean_dilatation<Shape>(c, e, strain);
      CornerForces<Shape, Real> force;
      for (Index q = 0; q < Shape::points; ++q)
        force.add(c, e, q,
                  c.point_volume.at(q, e) * (now.rotation[q] * full(elastic.stress(strain[q]))));
      if constexpr (Shape::hourglass) Hourglass<Real>(c, e, arms).add(c, e, 1.0, force);
      for (Index a = 0; a < Shape::nodes; ++a) {
        k.block[a][b][j] = -force.f[a].x;
        k.block[a][b][3 + j] = -force.f[a].y;
        k.block[a][b][6 + j] = -force.f[a].z;
      }
    }
  }
  return k;
}

}  // namespace cdem
