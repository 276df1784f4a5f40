// unbalance.cpp - see unbalance.hpp.
#include "core/diagnostics/unbalance.hpp"

#include <cmath>

#include "core/base/exact_sum.hpp"
#include "core/diagnostics/round_off.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

Real unbalance_ratio(const Model& m, const State& s) {
  const Real unbalanced = column_sum(s.nodes.unbalance);
  const LoadColumns loads = on_host(load_columns(m, s));
  const SupportColumns supports = on_host(support_columns(m, s));
  // what acts on supports needs no balance: a heavy fixed bed must not hide a block that slides
  Real applied = exact_sum(m.node_count, [&](Index i) {
    const Vec3<Real> f = loads.at(i).vector();
    return (supports.given(i, 0) ? 0 : std::abs(f.x)) + (supports.given(i, 1) ? 0 : std::abs(f.y)) +
           (supports.given(i, 2) ? 0 : std::abs(f.z));
  });
  const auto reaction = on_host(s.nodes.reaction);
  if (applied == 0)  // moved by its supports alone: compare with what they carry
    applied = exact_sum(m.node_count, [&](Index i) {
      const Real* r = reaction.data() + std::size_t(i) * 4;
      return std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]);
    });
  return unbalanced > RoundOff(m, s).force ? unbalanced / applied : 0;
}

}  // namespace cdem
