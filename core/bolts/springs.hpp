// springs.hpp - the stiffness of a bolt, for a solve.
#pragma once

#include <vector>

#include "core/bolts/solve_bolts.hpp"
#include "core/records/node_spring.hpp"

namespace cdem {

/// Stiffness of two springs in a row; none where one of them is missing.
inline Real in_series(Real a, Real b) { return a > 0 && b > 0 ? a * b / (a + b) : 0; }

/// A spring between two points of bolts, without a stiffness.
inline NodeSpring between(const SolveBolt& b, Index p, Index q) {
  static_assert(2 * bolt_hosts <= NodeSpring::most);
  NodeSpring spring;
  for (const Index point : {p, q})
    for (std::size_t k = std::size_t(point) * bolt_hosts; k < std::size_t(point + 1) * bolt_hosts;
         ++k) {
      if (b.hosts[k] < 0) continue;
      spring.node[spring.count] = b.hosts[k];
      spring.weight[spring.count++] = point == p ? -b.weights[k] : b.weights[k];
    }
  return spring;
}

/// A bar that becomes longer alone pulls the rest of the bolt on both sides: bars and grout there
/// are chains of springs. The pull of a bar on points farther off is left out.
inline void add_bars(const SolveBolt& b, const BoltChain& chain, std::vector<NodeSpring>& springs) {
  const BoltNodeColumns& n = chain.n;
  const auto tie = [&](Index i) {
    return chain.grout(i).tangent(SliderState(n.grout_state[i])) +
           chain.end(i).tangent(SliderState(n.end_state[i]));
  };
  const auto bar = [&](Index j) {
    return n.bar_broken[j] ? 0 : chain.bar(j).tangent(SliderState(n.bar_state[j]));
  };
  std::vector<Real> behind{tie(chain.first)}, ahead{tie(chain.last - 1)};
  for (Index i = chain.first + 1; i < chain.last; ++i)
    behind.push_back(tie(i) + in_series(bar(i - 1), behind.back()));
  for (Index i = chain.last - 2; i >= chain.first; --i)
    ahead.push_back(tie(i) + in_series(bar(i), ahead.back()));
  for (Index j = chain.first; chain.has_bar(j); ++j) {
    NodeSpring spring = between(b, j, j + 1);
    spring.axis = b.direction(j);
    spring.normal =
        in_series(bar(j), in_series(behind[j - chain.first], ahead[chain.last - 2 - j]));
    spring.shear = 0;
    if (spring.normal > 0) springs.push_back(spring);
  }
}

/// Dowels that do not yield.
inline void add_dowels(const SolveBolt& b, Index bolt, std::vector<NodeSpring>& springs) {
  for (Index c = b.crossing_first[bolt]; c < b.crossing_first[bolt + 1]; ++c) {
    const Index bar = b.dowels.bar[c], side = b.node_count + 2 * c;
    const Real* row = b.dowels.force + std::size_t(c) * 4;
    if (b.columns.bar_broken[bar] ||
        !(norm(Vec3<Real>{row[0], row[1], row[2]}) < b.dowels.dowel[2 * c + 1]))
      continue;
    NodeSpring spring = between(b, side, side + 1);
    spring.axis = b.axis(bar, bolt);
    spring.normal = 0;
    spring.shear = b.dowels.dowel[2 * c];
    springs.push_back(spring);
  }
}

/// Of a bolt that acts, where its last step has left it.
inline void add_springs(const SolveBolt& b, Index bolt, std::vector<NodeSpring>& springs) {
  if (BoltPhase(b.phase[bolt]) != BoltPhase::acting) return;
  add_bars(
      b,
      {b.columns, BoltProperties::at(b.properties, bolt), b.first[bolt], b.first[bolt + 1], false},
      springs);
  add_dowels(b, bolt, springs);
}

}  // namespace cdem
