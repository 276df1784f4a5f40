// health.cpp - see health.hpp.
#include "core/diagnostics/health.hpp"

#include <cmath>

namespace cdem {

Report check_health(const Model& m, const State& s) {
  Real fastest = 0;
  Index node = -1;
  const bool scaled = s.nodes.relax_mass.size() > 0;
  for (Index i = 0; i < m.node_count; ++i) {
    const Real* r = s.nodes.motion.data() + std::size_t(i) * 8;
    // scaled masses: the speed with which the true one would have as much energy
    const Real heavier = scaled ? s.nodes.relax_mass[i] / m.mass[i] : 1.0;
    const Real v2 = heavier * (r[4] * r[4] + r[5] * r[5] + r[6] * r[6]);
    if (!std::isfinite(v2) || !std::isfinite(r[0] + r[1] + r[2]))
      return {Outcome::not_finite, i, v2};
    if (v2 > fastest) fastest = v2, node = i;
  }
  if (m.speed_limit > 0 && std::sqrt(fastest) > m.speed_limit)
    return {Outcome::too_fast, node, std::sqrt(fastest)};
  for (std::size_t i = 0; i < s.search.exposed_face.size(); ++i) {
    bool lost = s.edges.lost[i] != 0;
    for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) lost = lost || s.springs.lost[k];
    if (lost) return {Outcome::lost_contact, Index(i), 0};
  }
  return {};
}

}  // namespace cdem
