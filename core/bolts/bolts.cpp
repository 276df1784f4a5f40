// bolts.cpp - see bolts.hpp.
#include "core/bolts/bolts.hpp"

#include "core/base/parallel.hpp"
#include "core/bolts/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

void update_bolt_forces(const Model& m, State& s, Queue q) {
  if (m.bolts.count == 0) return;
  const PhaseTimer timer(s, Phase::contact);
  for_each_item(q, m.bolts.count, bolt_solver(m, s));
}

void cut_bolt(const BoltSet& b, const Flag* out, BoltState& bs, Index bolt) {
  const auto hosts = on_host(b.hosts);
  const auto grout_lost = on_host(bs.grout_lost), bar_broken = on_host(bs.bar_broken);
  const Index first = on_host(b.first)[bolt], last = on_host(b.first)[bolt + 1];
  for (Index n = first; n < last; ++n) {
    bool lost = false;
    for (std::size_t k = std::size_t(n) * bolt_hosts; k < std::size_t(n + 1) * bolt_hosts; ++k)
      lost |= hosts[k] >= 0 && out[hosts[k]];
    if (!lost) continue;
    grout_lost[n] = 1;
    for (Index j = n > first ? n - 1 : n; j <= n && j + 1 < last; ++j)
      if (!bar_broken[j]) bar_broken[j] = Flag(BarState::cut);
  }
}

}  // namespace cdem
