// chain_columns.hpp - a bolt for tests: a plate at its head, grout, an anchor at its toe.
#pragma once

#include <vector>

#include "core/bolts/chain.hpp"

namespace cdem::test {

/// A straight bolt of equal parts; `stretch` is how much longer the rock makes each bar.
struct ChainColumns {
  Index count;
  std::vector<Real> grout, end, slip, grout_free, end_free, grout_force, end_force, length,
      bar_free, axial_force, scratch;
  std::vector<Flag> grout_lost, grout_state, end_state, bar_state, bar_broken;
  BoltProperties steel{.axial_stiffness = 18e6,
                       .yield = 1e9,
                       .crush = 1e9,
                       .rupture_strain = 1e300,
                       .pretension = 0};
  bool jacked = false;

  ChainColumns(Index nodes, Real part, Real grout_stiffness, Real grout_strength)
      : count(nodes),
        grout(2 * nodes),
        end(2 * nodes),
        length(nodes, part),
        scratch(bolt_scratch * nodes) {
    for (auto* column :
         {&slip, &grout_free, &end_free, &grout_force, &end_force, &bar_free, &axial_force})
      column->resize(nodes);
    for (auto* column : {&grout_lost, &grout_state, &end_state, &bar_state, &bar_broken})
      column->resize(nodes);
    for (Index i = 0; i < nodes; ++i) {
      grout[2 * i] = grout_stiffness * part;
      grout[2 * i + 1] = grout_strength * part;
      scratch[std::size_t(i) * bolt_scratch + 3] = part;
    }
  }

  void stretch(Index bar, Real by) {
    scratch[std::size_t(bar) * bolt_scratch + 3] = length[bar] + by;
  }
  BoltChain chain() {
    return {.n = {.grout = grout.data(),
                  .end = end.data(),
                  .grout_lost = grout_lost.data(),
                  .slip = slip.data(),
                  .grout_free = grout_free.data(),
                  .end_free = end_free.data(),
                  .grout_force = grout_force.data(),
                  .end_force = end_force.data(),
                  .length = length.data(),
                  .bar_free = bar_free.data(),
                  .axial_force = axial_force.data(),
                  .grout_state = grout_state.data(),
                  .end_state = end_state.data(),
                  .bar_state = bar_state.data(),
                  .bar_broken = bar_broken.data(),
                  .scratch = scratch.data()},
            .steel = steel,
            .first = 0,
            .last = count,
            .jacked = jacked};
  }
  Real bar_force(Index j) {
    const BoltChain c = chain();
    return c.has_bar(j) ? c.bar(j).force(c.extension(j), SliderState(bar_state[j])) : 0;
  }
  /// What the forces on a node are off by  [N].
  Real residual(Index i) {
    const BoltChain c = chain();
    return bar_force(i) - (i > 0 ? bar_force(i - 1) : 0) -
           c.grout(i).force(slip[i], SliderState(grout_state[i])) -
           c.end(i).force(slip[i], SliderState(end_state[i]));
  }
};

}  // namespace cdem::test
