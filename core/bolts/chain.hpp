// chain.hpp - axial equilibrium of one bolt: sliders along a line, solved by the Thomas algorithm.
#pragma once

#include "core/bolts/bolt.hpp"

namespace cdem {

/// So many passes at most: each solves the chain with the states that the one before has left.
inline constexpr int most_bolt_passes = 50;
/// Halvings of the search along a step of Newton's method.
inline constexpr int bolt_search_steps = 30;
/// A pivot below this share of its diagonal is round-off: that part of the bolt hangs on nothing.
inline constexpr Real least_bolt_pivot = 1e-13;

/// Nodes of one bolt between the rock that moves and the steel: node i has slipped by d_i along the
/// bolt. Bar j is longer by (L_j - L0_j) + d_j+1 - d_j than at its installation. Equilibrium:
///
///   N_i - N_i-1 = g_i + e_i     bars, grout, and the plate (first node) or anchor (last node)
struct BoltChain {
  BoltNodeColumns n;
  BoltProperties steel;
  Index first, last;  // nodes of the bolt: first to before last
  bool jacked;        // the plate is pulled on with the pretension, in this step

  CDEM_HD bool has_bar(Index j) const { return j + 1 < last; }

  CDEM_HD Slider bar(Index j) const {
    const Real k = steel.axial_stiffness / n.length[j];
    if (n.bar_broken[j]) return {k, n.bar_free[j], 0, 0};
    return {k, n.bar_free[j], -steel.crush, steel.yield};
  }
  CDEM_HD Slider grout(Index i) const {
    const Real limit = n.grout_lost[i] ? 0.0 : n.grout[2 * i + 1];
    return {n.grout[2 * i], n.grout_free[i], -limit, limit};
  }
  /// A plate only presses on the face; an anchor holds both ways.
  CDEM_HD Slider end(Index i) const {
    const Real limit = n.grout_lost[i] ? 0.0 : n.end[2 * i + 1];
    if (i == first && jacked)
      return {n.end[2 * i], n.end_free[i], steel.pretension, steel.pretension};
    return {n.end[2 * i], n.end_free[i], i == first ? 0.0 : -limit, limit};
  }
  /// How much longer a bar is than at its installation  [m].
  CDEM_HD Real extension(Index j) const {
    return scratch(j)[3] - n.length[j] + (n.slip[j + 1] - n.slip[j]);
  }

  /// Bring the slips into equilibrium. The states of the last step are the first guess: where they
  /// hold, one pass is enough. Else Newton's method on the energy of the bolt, which is convex,
  /// with a search along each of its steps, ends at its only minimum.
  CDEM_HD void solve() const {
    for (int pass = 0; pass < most_bolt_passes; ++pass) {
      find_changes();
      move(1);
      if (!renew_states()) return;
      const Real back = too_far();
      if (back == 0) continue;
      move(-back);
      if (!renew_states() && back == 1) return;
    }
  }

  /// Mark bars that are torn by now; whether there are any.
  CDEM_HD bool tear() const {
    bool any = false;
    for (Index j = first; has_bar(j); ++j) {
      if (n.bar_broken[j] || !(extension(j) > steel.rupture_strain * n.length[j])) continue;
      n.bar_broken[j] = Flag(BarState::ruptured);
      any = true;
    }
    return any;
  }

 private:
  CDEM_HD Real* scratch(Index i) const { return n.scratch + std::size_t(i) * bolt_scratch; }

  /// Slope of the energy along the changes, where the slips are plus a part of the changes  [J].
  CDEM_HD Real slope(Real part) const {
    const auto at = [&](Index i) { return n.slip[i] + part * scratch(i)[6]; };
    Real sum = 0;
    for (Index i = first; i < last; ++i) {
      const Slider g = grout(i), e = end(i);
      const Real x = at(i);
      sum += (g.force(x, g.state(x)) + e.force(x, e.state(x))) * scratch(i)[6];
      if (!has_bar(i)) continue;
      const Slider s = bar(i);
      const Real longer = scratch(i)[3] - n.length[i] + (at(i + 1) - x);
      sum += s.force(longer, s.state(longer)) * (scratch(i + 1)[6] - scratch(i)[6]);
    }
    return sum;
  }

  /// Fraction of the changes just made that is beyond the least energy along them: 0 if it falls
  /// all the way, 1 if it rises from the first (the guess of the states was wrong).
  CDEM_HD Real too_far() const {
    if (!(slope(0) > 0)) return 0;
    if (!(slope(-1) < 0)) return 1;
    Real near = 0, far = 1;
    for (int k = 0; k < bolt_search_steps; ++k) {
      const Real middle = 0.5 * (near + far);
      (slope(-middle) > 0 ? near : far) = middle;
    }
    return far;
  }
  CDEM_HD void move(Real part) const {
    for (Index i = first; i < last; ++i) n.slip[i] += part * scratch(i)[6];
  }

  /// One linear solve: pivots and right sides forwards, then the changes of the slips backwards.
  CDEM_HD void find_changes() const {
    Real bar_before = 0, force_before = 0, off_before = 0, right_before = 0;
    for (Index i = first; i < last; ++i) {
      Real bar_after = 0, force_after = 0;
      if (has_bar(i)) {
        const Slider s = bar(i);
        const SliderState on = SliderState(n.bar_state[i]);
        bar_after = s.tangent(on);
        force_after = s.force(extension(i), on);
      }
      const Slider g = grout(i), e = end(i);
      const SliderState g_on = SliderState(n.grout_state[i]), e_on = SliderState(n.end_state[i]);
      const Real diagonal = bar_before + bar_after + g.tangent(g_on) + e.tangent(e_on);
      const Real residual =
          force_after - force_before - g.force(n.slip[i], g_on) - e.force(n.slip[i], e_on);
      // row i: -bar_before x_i-1 + diagonal x_i - bar_after x_i+1 = residual
      const Real pivot = diagonal - bar_before * off_before;
      const bool hangs = !(pivot > least_bolt_pivot * diagonal);
      off_before = hangs ? 0 : bar_after / pivot;
      right_before = hangs ? 0 : (residual + bar_before * right_before) / pivot;
      scratch(i)[4] = off_before;
      scratch(i)[5] = right_before;
      bar_before = bar_after;
      force_before = force_after;
    }
    Real change = 0;
    for (Index i = last - 1; i >= first; --i) {
      change = scratch(i)[5] + scratch(i)[4] * change;
      scratch(i)[6] = change;
    }
  }

  CDEM_HD static bool renew(Flag& state, SliderState now) {
    const bool changes = state != Flag(now);
    state = Flag(now);
    return changes;
  }
  /// States at the slips as they are; whether any has changed.
  CDEM_HD bool renew_states() const {
    bool any = false;
    for (Index i = first; i < last; ++i) {
      any |= renew(n.grout_state[i], grout(i).state(n.slip[i]));
      any |= renew(n.end_state[i], end(i).state(n.slip[i]));
      if (has_bar(i)) any |= renew(n.bar_state[i], bar(i).state(extension(i)));
    }
    return any;
  }
};

}  // namespace cdem
