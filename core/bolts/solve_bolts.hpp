// solve_bolts.hpp - the step of bolts: from the motion of the rock to the forces that bolts put on
// it.
#pragma once

#include "core/bolts/chain.hpp"

namespace cdem {

/// Each bolt is massless: it is in equilibrium along its axis in every step. Its bars pull the
/// points that its nodes lie at towards each other, which is the derivative of its energy by these
/// points: forces and moments sum to zero whatever its shape. Across joints dowels act between the
/// points at which the bolt leaves one block and enters the other.
struct SolveBolt {
  InMotion nodes;
  const Index *first, *crossing_first;  // [bolt + 1]
  Index node_count;                     // of all bolts; points of crossings follow
  const Index* hosts;                   // [point][8] nodes of the rock, or -1
  const Real* weights;                  // [point][8]
  const Real* properties;               // rows of BoltProperties
  BoltNodeColumns columns;
  DowelColumns dowels;
  Flag* phase;                   // [bolt]
  Real *stored, *lost, *jacked;  // [bolt]  [J]
  Real* corner_force;            // [point][8] rows of 4

  CDEM_HD void operator()(One item) const {
    const Index bolt = item.i;
    const BoltPhase now = BoltPhase(phase[bolt]);
    if (now != BoltPhase::placed && now != BoltPhase::acting) return;
    const bool placed = now == BoltPhase::placed;
    BoltChain chain{columns, BoltProperties::at(properties, bolt), first[bolt], first[bolt + 1],
                    placed && BoltProperties::at(properties, bolt).pretension > 0};
    measure(chain, placed);
    do {
      chain.solve();
    } while (chain.tear());
    stored[bolt] = 0;
    take_forces(chain, bolt);
    pull(chain);
    for (Index c = crossing_first[bolt]; c < crossing_first[bolt + 1]; ++c) shear(c, bolt, placed);
    phase[bolt] = Flag(BoltPhase::acting);
  }

  CDEM_HD Vec3<Real> direction(Index j) const {
    return (1 / scratch(j)[3]) * (place(j + 1) - place(j));
  }
  /// Direction of the bolt in the two blocks beside the bar that leads across a joint, which itself
  /// leans where the joint has shifted.
  CDEM_HD Vec3<Real> axis(Index bar, Index bolt) const {
    const bool before = bar > first[bolt], after = bar + 2 < first[bolt + 1];
    if (!before && !after) return direction(bar);
    const Vec3<Real> none{0, 0, 0};
    return unit((before ? direction(bar - 1) : none) + (after ? direction(bar + 1) : none));
  }

 private:
  CDEM_HD Vec3<Real> point(Index p) const {
    Vec3<Real> x{0, 0, 0};
    for (std::size_t k = std::size_t(p) * bolt_hosts; k < std::size_t(p + 1) * bolt_hosts; ++k)
      if (hosts[k] >= 0) x = x + weights[k] * nodes.position(hosts[k]);
    return x;
  }
  CDEM_HD Real* scratch(Index i) const { return columns.scratch + std::size_t(i) * bolt_scratch; }
  CDEM_HD Vec3<Real> place(Index i) const { return {scratch(i)[0], scratch(i)[1], scratch(i)[2]}; }

  /// Places of the nodes and lengths of the bars now.
  CDEM_HD void measure(const BoltChain& chain, bool placed) const {
    for (Index i = chain.first; i < chain.last; ++i) {
      const Vec3<Real> x = point(i);
      Real* r = scratch(i);
      r[0] = x.x, r[1] = x.y, r[2] = x.z;
      if (i > chain.first) scratch(i - 1)[3] = norm(x - place(i - 1));
    }
    for (Index j = chain.first; placed && chain.has_bar(j); ++j) columns.length[j] = scratch(j)[3];
  }

  /// Store force and loss of a slider. Lost is the mean of both forces times the change of the
  /// place where it is free: with the stored energy, exactly the work that central differences
  /// count.
  CDEM_HD Real take(const Slider& s, Real x, SliderState on, Real& free, Real& force,
                    Index bolt) const {
    const Real after = s.force(x, on), free_after = s.free_after(x, after);
    const Real spent = 0.5 * (force + after) * (free_after - free);
    force = after;
    free = free_after;
    stored[bolt] += s.stored(after);
    return spent;
  }
  CDEM_HD void take_forces(const BoltChain& chain, Index bolt) const {
    const BoltNodeColumns& n = columns;
    Real sum = 0, jack = 0;
    for (Index i = chain.first; i < chain.last; ++i) {
      sum += take(chain.grout(i), n.slip[i], SliderState(n.grout_state[i]), n.grout_free[i],
                  n.grout_force[i], bolt);
      const bool jacks = i == chain.first && chain.jacked;
      const Slider end = chain.end(i);
      const SliderState on = SliderState(n.end_state[i]);
      const Real before = n.end_free[i];
      const Real spent = take(end, n.slip[i], on, n.end_free[i], n.end_force[i], bolt);
      (jacks ? jack : sum) += spent;
      // a plate that lifts off stays where it was on the bolt
      if (i == chain.first && on == SliderState::lower && !jacks) n.end_free[i] = before;
      if (chain.has_bar(i))
        sum += take(chain.bar(i), chain.extension(i), SliderState(n.bar_state[i]), n.bar_free[i],
                    n.axial_force[i], bolt);
    }
    lost[bolt] += sum;
    jacked[bolt] -= jack;
  }

  CDEM_HD void put(Index p, const Vec3<Real>& f) const {
    for (std::size_t k = std::size_t(p) * bolt_hosts; k < std::size_t(p + 1) * bolt_hosts; ++k) {
      Real* row = corner_force + 4 * k;
      row[0] = weights[k] * f.x, row[1] = weights[k] * f.y, row[2] = weights[k] * f.z;
    }
  }
  /// Bars pull the points at their ends together.
  CDEM_HD void pull(const BoltChain& chain) const {
    Vec3<Real> before{0, 0, 0};
    for (Index i = chain.first; i < chain.last; ++i) {
      const Vec3<Real> after =
          chain.has_bar(i) ? columns.axial_force[i] * direction(i) : Vec3<Real>{0, 0, 0};
      put(i, after - before);
      before = after;
    }
  }

  /// Dowel: resists the shift of the two sides of a joint across the bolt.
  CDEM_HD void shear(Index c, Index bolt, bool placed) const {
    const Index bar = dowels.bar[c], side = node_count + 2 * c;
    const Vec3<Real> t = axis(bar, bolt);
    const auto across = [&](const Vec3<Real>& v) { return v - dot(v, t) * t; };
    const Vec3<Real> jump = across(point(side + 1) - point(side));
    Real *free_row = dowels.free_jump + std::size_t(c) * 4,
         *force_row = dowels.force + std::size_t(c) * 4;
    const Vec3<Real> free_before =
        placed ? jump : across(Vec3<Real>{free_row[0], free_row[1], free_row[2]});
    const Vec3<Real> force_before{force_row[0], force_row[1], force_row[2]};
    const Real stiffness = dowels.dowel[2 * c];
    const Real limit = columns.bar_broken[bar] ? 0.0 : dowels.dowel[2 * c + 1];
    Vec3<Real> force = stiffness * (jump - free_before), free = free_before;
    const Real size = norm(force);
    if (size > limit) {
      force = (limit / size) * force;
      free = jump - (1 / stiffness) * force;
      lost[bolt] += 0.5 * dot(force_before + force, free - free_before);
    }
    if (stiffness > 0) stored[bolt] += 0.5 * dot(force, force) / stiffness;
    Row::of(free.x, free.y, free.z).store(free_row);
    Row::of(force.x, force.y, force.z).store(force_row);
    put(side, force);
    put(side + 1, -force);
  }
};

}  // namespace cdem
