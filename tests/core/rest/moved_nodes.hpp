// moved_nodes.hpp - compare a matrix with the forces that small displacements give.
#pragma once

#include "core/rest/item_matrix.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

inline constexpr Real small = 1e-7;  // way of a node  [m]

/// Check a matrix against forces(node) where one node moves, with an error of this part of it.
template <class Forces>
void check_matrix(Scene& scene, const ItemMatrix& k, const Forces& forces) {
  Real largest = 0;
  for (Index a = 0; a < k.count; ++a)
    for (Index n = 0; n < 9; ++n) largest = std::max(largest, std::abs(k.block[a][a][n]));
  for (Index b = 0; b < k.count; ++b)
    for (Index j = 0; j < 3; ++j) {
      Real& x = scene.motion(k.node[b])[j];
      const Real kept = x;
      x = kept + small;
      const std::vector<Vec> above = forces();
      x = kept - small;
      const std::vector<Vec> below = forces();
      x = kept;
      for (Index a = 0; a < k.count; ++a) {
        const Vec rate = Real(-0.5 / small) * (above[a] - below[a]);
        const Real* block = k.block[a][b];
        const Vec exact{block[j], block[3 + j], block[6 + j]};
        CHECK(distance(rate, exact) < 1e-6 * largest);
      }
    }
}

/// Turn a scene as a whole.
inline void turn(Scene& scene, const Mat& rotation) {
  for (Index i = 0; i < scene.model.node_count; ++i)
    put(scene.motion(i), rotation * scene.position(i));
}

}  // namespace cdem::test
