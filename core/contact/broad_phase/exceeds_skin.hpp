// exceeds_skin.hpp - has a node left its predicted path?
#pragma once

#include "core/base/views.hpp"

namespace cdem {

/// Is a node farther than its skin from the path that was predicted for it?
struct ExceedsSkin {
  InMotion nodes;
  InIndices nodes_of;  // [predicted]
  InRows predicted;    // PredictedNode
  Real after;          // since the prediction  [s]

  template <class I>
  CDEM_HD auto operator()(I item) const {
    using T = Number<I>;
    const Four<T> then = predicted.at(item, 0), velocity = predicted.at(item, 4);
    const Vec3<T> off =
        nodes.position(nodes_of.at(0, item)) - then.vector() - T(after) * velocity.vector();
    return dot(off, off) > then.w;
  }
};

}  // namespace cdem
