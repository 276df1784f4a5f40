// data.cpp - see data.hpp.
#include "core/bolts/data.hpp"

#include "core/base/parallel.hpp"
#include "core/bolts/springs.hpp"
#include "core/bolts/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

/// Cut a bolt's bars, and drop its grout, in excavated rock.
void cut(const BoltSet& b, const Flag* out, BoltState& bs, Index bolt) {
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

}  // namespace

void Bolts::size(const Given& b, State& s) {
  const std::size_t nodes = bolt_node_count(b);
  s.phase.resize(b.count);
  const auto phase = on_host(s.phase);
  const auto waits = on_host(b.waits);
  for (Index i = 0; i < b.count; ++i)
    phase[i] = Flag(waits[i] ? BoltPhase::waiting : BoltPhase::placed);
  for (Column<Real>* column : {&s.slip, &s.grout_free, &s.end_free, &s.grout_force, &s.end_force,
                               &s.length, &s.bar_free, &s.axial_force})
    column->resize(nodes);
  for (Column<Flag>* column :
       {&s.grout_state, &s.end_state, &s.bar_state, &s.bar_broken, &s.grout_lost})
    column->resize(nodes);
  for (Column<Real>* column : {&s.dowel_free, &s.dowel_force})
    column->resize(4 * b.crossing_bar.size());
  for (Column<Real>* column : {&s.stored, &s.lost, &s.jacked}) column->resize(b.count);
  s.scratch.resize(8 * nodes);
}

void Bolts::act(const Model& m, cdem::State& s, Queue q) {
  const Index count = given_of<Bolts>(m).count;
  if (count == 0) return;
  const PhaseTimer timer(s, Phase::contact);
  for_each_item(q, count, bolt_solver(m, s));
}

std::vector<NodeSpring> Bolts::springs(const Model& m, cdem::State& s) {
  const SolveBolt bolts = on_host(bolt_solver(m, s));
  std::vector<NodeSpring> springs;
  for (Index bolt = 0; bolt < given_of<Bolts>(m).count; ++bolt) add_springs(bolts, bolt, springs);
  return springs;
}

void Bolts::take_out(const Given& b, State& s, const std::vector<Index>& which, const Flag* out) {
  for (const Index bolt : which) cut(b, out, s, bolt);
}

void Bolts::bring_in(const Given& b, State& bs, const Flag* out) {
  const auto first = on_host(b.first);
  const auto phase = on_host(bs.phase);
  const auto grout_lost = on_host(bs.grout_lost), bar_broken = on_host(bs.bar_broken);
  for (Index i = 0; i < b.count; ++i) {
    if (phase[i] != Flag(BoltPhase::waiting)) continue;
    for (Index n = first[i]; n < first[i + 1]; ++n) grout_lost[n] = bar_broken[n] = 0;
    cut(b, out, bs, i);
  }
}

void Bolts::install(const Given& b, State& s, const Flag* which) {
  const auto phase = on_host(s.phase);
  for (Index i = 0; i < b.count; ++i)
    if (which[i] && phase[i] == Flag(BoltPhase::waiting)) phase[i] = Flag(BoltPhase::placed);
}

void Bolts::remove(const Given& b, State& s, const Flag* which) {
  const auto first = on_host(b.first), crossing_first = on_host(b.crossing_first);
  const auto phase = on_host(s.phase);
  const auto lost = on_host(s.lost), stored = on_host(s.stored);
  const auto grout_force = on_host(s.grout_force), end_force = on_host(s.end_force);
  const auto axial_force = on_host(s.axial_force), dowel_force = on_host(s.dowel_force);
  for (Index i = 0; i < b.count; ++i) {
    if (!which[i]) continue;
    phase[i] = Flag(BoltPhase::removed);
    lost[i] += stored[i];
    stored[i] = 0;
    for (Index n = first[i]; n < first[i + 1]; ++n)
      grout_force[n] = end_force[n] = axial_force[n] = 0;
    for (Index c = 4 * crossing_first[i]; c < 4 * crossing_first[i + 1]; ++c) dowel_force[c] = 0;
  }
}

}  // namespace cdem
