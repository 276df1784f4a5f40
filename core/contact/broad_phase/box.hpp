// box.hpp - boxes along the axes.
#pragma once

#include "core/base/math.hpp"

namespace cdem {

struct Box {
  Real low[3], high[3];

  CDEM_HD void include(const Vec3<Real>& p) {
    const Real x[3] = {p.x, p.y, p.z};
    for (int d = 0; d < 3; ++d) {
      low[d] = min_of(x[d], low[d]);
      high[d] = max_of(x[d], high[d]);
    }
  }
  CDEM_HD void include(const Box& b) {
    for (int d = 0; d < 3; ++d) {
      low[d] = min_of(b.low[d], low[d]);
      high[d] = max_of(b.high[d], high[d]);
    }
  }
  CDEM_HD void inflate(Real by) {
    for (int d = 0; d < 3; ++d) low[d] -= by, high[d] += by;
  }
  CDEM_HD bool overlaps(const Box& b) const {
    bool apart = false;
    for (int d = 0; d < 3; ++d) apart = apart || low[d] > b.high[d] || b.low[d] > high[d];
    return !apart;
  }
  CDEM_HD static Box nothing() { return {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}}; }
};

}  // namespace cdem
