// bonded_pairs.hpp - bonds of conforming pairs of faces, and of faces that overlap.
#pragma once

#include "core/bonds/bond_point.hpp"
#include "core/contact/geometry/face_geometry.hpp"
#include "core/interfaces/laws.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

/// Frame of a pair of faces from the mean of both sides' vertices; n points from the first face
/// into the second.
template <Index count, class T>
CDEM_HD inline Frame<T> pair_frame(const Vec3<T>* mean) {
  const Vec3<T> last = mean[count - 1];
  const Vec3<T> n = unit(cross(mean[2] - mean[0], last - mean[1]));
  const Vec3<T> side = mean[1] - mean[0];
  const Vec3<T> t1 = unit(side - dot(n, side) * n);
  return {n, t1, cross(n, t1)};
}

/// From values at the vertices to those at the bond points.
template <Index count, class T>
CDEM_HD inline void move_inside(Real indentation, Vec3<T>* values) {
  const T own(1.0 - indentation), shared(indentation / count);
  Vec3<T> sum{T(0.0), T(0.0), T(0.0)};
  for (Index k = 0; k < count; ++k) sum = sum + values[k];
  for (Index k = 0; k < count; ++k) values[k] = own * values[k] + shared * sum;
}

/// State and properties of bonded pairs that do not depend on their number of vertices.
struct PairColumns {
  InIndices interface;  // [1][pair]: index of the interface's properties
  InTable area;         // [1][pair] true overlap area  [m2]
  InFlags status;       // [pair] PairStatus
  InTable stiffness;    // [2][pair] k_n, k_s  [Pa/m]
  InTable strength;     // [1][pair] factor on the strength; empty: all 1
  InterfaceTable interfaces;
  InOutTable bond, slip1, slip2;  // [point][pair]
  InTable rest;  // [axis * points + point][pair] jump at which the spring is free, along n, t1 and
                 // t2 of the pair: that of the initial stress; empty: all zero  [m]
  InOutTable rise;     // [point][pair] of that jump along n, by dilation; empty: all zero  [m]
  InOutTable history;  // [variable * points + point][pair] of the laws
  InOutTable broken_tension, broken_shear;  // [1][pair] springs broken so far, by cause
  InOutTable jump;  // [1][pair] how far the largest jump has changed since its last point broke [m]
  InOutTable jump_at_break;  // [1][pair] its value at that time; -1 while a point holds  [m]
  InOutTable stored, fracture, friction;  // [1][pair]  [J]

  /// Which pairs are not released, and which are open hinges.
  template <class I>
  CDEM_HD auto are_live(I p) const {
    return !status.equal(Flag(PairStatus::released), p);
  }
  template <class I>
  CDEM_HD auto are_hinges(I p) const {
    return status.equal(Flag(PairStatus::hinge), p);
  }
  /// The law of a pair.
  template <class Laws, class I>
  CDEM_HD auto laws(I p) const {
    auto of = joint_laws<Laws>(interfaces, interface.at(0, p));
    if (strength.data) of.scatter = {true, strength.at(0, p)};
    return of;
  }
  /// State of the law of a pair at point k of `points`; the point's number is its row.
  template <class Laws, class I, class T>
  CDEM_HD void load_history(I p, Index k, Index points, T* state) const {
    const bool any = interfaces.has_state;
    for (Index v = 0; v < Laws::most_state; ++v)
      state[v] = any ? history.at(v * points + k, p) : T(0.0);
  }
  template <class Laws, class I, class M, class T>
  CDEM_HD void store_history(I p, Index k, Index points, const M& live, const T* state) const {
    if (!interfaces.has_state) return;
    for (Index v = 0; v < Laws::most_state; ++v)
      history.set(v * points + k, p, select(live, state[v], history.at(v * points + k, p)));
  }
  /// The part of a jump that strains the spring of point k.
  template <class I, class T>
  CDEM_HD Vec3<T> past_rest(I p, Index k, Index points, const Frame<T>& f,
                            const Vec3<T>& jump) const {
    Vec3<T> past = jump;
    if (rest.data)
      past = jump - rest.at(k, p) * f.n - rest.at(points + k, p) * f.t1 -
             rest.at(2 * points + k, p) * f.t2;
    return rise.data ? past - rise.at(k, p) * f.n : past;
  }
  /// The gap at which the spring of point k is free of stress, in the normal direction  [m].
  template <class I>
  CDEM_HD Number<I> lift(I p, Index k) const {
    using T = Number<I>;
    return (rest.data ? rest.at(k, p) : T(0.0)) + (rise.data ? rise.at(k, p) : T(0.0));
  }
  /// The history of point k that every law has.
  template <class I>
  CDEM_HD BondHistory<Number<I>> history_of(I p, Index k) const {
    using T = Number<I>;
    return {.bond = bond.at(k, p),
            .slip1 = slip1.at(k, p),
            .slip2 = slip2.at(k, p),
            .rise = rise.data ? rise.at(k, p) : T(0.0)};
  }
  template <class I, class M>
  CDEM_HD void set_history(I p, Index k, const M& live, const BondHistory<Number<I>>& old,
                           const BondHistory<Number<I>>& h) const {
    bond.set(k, p, select(live, h.bond, old.bond));
    slip1.set(k, p, select(live, h.slip1, old.slip1));
    slip2.set(k, p, select(live, h.slip2, old.slip2));
    if (rise.data) rise.set(k, p, select(live, h.rise, old.rise));
  }
  /// Spring of a point with this area  [m2].
  template <class I>
  CDEM_HD BondSpring<Number<I>> spring(I p, const Number<I>& point_area) const {
    return {.area = point_area,
            .stiffness = JointStiffness<Number<I>>::of(stiffness.at(0, p), stiffness.at(1, p))};
  }

  /// A pair that opened as a hinge has a wide jump when its last point breaks: what counts for its
  /// release is how far it has moved since.
  template <class I, class M, class T>
  CDEM_HD void note_jump(I p, const M& broken, const T& widest) const {
    const T none(-1.0), zero(0.0), old = jump_at_break.at(0, p);
    const T start = select(broken, select(old < zero, widest, old), none);
    jump_at_break.set(0, p, start);
    jump.set(0, p, select(broken, abs_of(widest - start), zero));
  }
};

/// The ends of the bonds of pairs, once contacts have taken over their force.
struct BondEnds {
  PairColumns pairs;
  OutForces corner_force;  // of the pairs
  Index corners;           // rows of a pair

  /// Energy that no contact holds is lost to friction. A pair that is released bears nothing:
  /// kernels leave its rows as they are, or clear them where others of a pack are live, so that the
  /// state does not depend on the width of packs.
  CDEM_HD void end(One pair) const {
    pairs.friction.set(0, pair, pairs.friction.at(0, pair) + pairs.stored.at(0, pair));
    pairs.stored.set(0, pair, 0);
    for (Index k = 0; k < corners; ++k) corner_force.set(pair, corners, k, {0.0, 0.0, 0.0});
  }
};

/// Bonds of conforming pairs: `count` vertices on either side coincide at the start. Run by
/// WithLaws.
///
/// Point k sits at constant weights (1 - a) delta_kj + a / count on both faces and carries
/// area / count. The six half springs of two triangles (Fig. 14) are three whole ones: the same.
template <Index count>
struct ConformingBonds {
  InMotion nodes;
  InIndices pair_nodes;  // [2 * count][pair]: vertices of the first face, then their mates
  PairColumns pairs;
  Real indentation;  // a: 0 at the vertices, 1/2 (3) or 1 - 1/sqrt(3) (4) as quadrature points
  Real dt;
  bool sampled;            // does anything ask for the energy of intact pairs?
  OutForces corner_force;  // [pair][count]: on the mates; on the first face's vertices the opposite

  template <class Laws, class I>
  CDEM_HD void update(I p) const {
    using T = Number<I>;
    const auto live = pairs.are_live(p);
    if (!any_of(live)) return;
    Vec3<T> jump[count], force[count];
    const Frame<T> frame = gather_jumps(p, jump);
    if (any_of(live & !all_bear<Laws>(p, frame, jump, force))) {
      update_history<Laws>(p, live, frame, jump, force);
    } else if (sampled) {
      const auto laws = pairs.template laws<Laws>(p);
      const BondSpring<T> own = spring(p);
      T stored(0.0);
      for (Index k = 0; k < count; ++k) {
        T state[Laws::most_state + 1];
        pairs.load_history<Laws>(p, k, count, state);
        stored += intact_energy(laws, own, frame, jump[k], state);
      }
      pairs.stored.set(0, p, select(live, stored, T(0.0)));
    }
    write_forces(p, live, force);
  }

  static constexpr Fetching fetching{2, 1024};
  /// The mates: the first face's vertices come in the order of the pairs.
  CDEM_HD void fetch(One p) const {
    for (Index k = count; k < 2 * count; ++k) nodes.fetch(pair_nodes.at(k, p));
  }

  /// Mean positions of mated vertices, and the jumps there.
  template <class I, class T>
  CDEM_HD void gather_vertices(I p, Vec3<T>* mean, Vec3<T>* jump) const {
    for (Index k = 0; k < count; ++k) {
      const Vec3<T> xa = nodes.position(pair_nodes.at(k, p));
      const Vec3<T> xb = nodes.position(pair_nodes.at(count + k, p));
      mean[k] = T(0.5) * (xa + xb);
      jump[k] = xb - xa;
    }
  }
  /// Frame of the pair, and the jumps at the bond points that strain their springs.
  template <class I, class T>
  CDEM_HD Frame<T> gather_jumps(I p, Vec3<T>* jump) const {
    Vec3<T> mean[count];
    gather_vertices(p, mean, jump);
    move_inside<count>(indentation, jump);
    const Frame<T> frame = pair_frame<count>(mean);
    for (Index k = 0; k < count; ++k) jump[k] = pairs.past_rest(p, k, count, frame, jump[k]);
    return frame;
  }
  /// Rates of the jumps at the bond points  [m/s].
  template <class I, class T>
  CDEM_HD void gather_rates(I p, Vec3<T>* rate) const {
    for (Index k = 0; k < count; ++k)
      rate[k] = nodes.velocity(pair_nodes.at(count + k, p)) - nodes.velocity(pair_nodes.at(k, p));
    move_inside<count>(indentation, rate);
  }
  /// Mean positions of mated vertices one step ago, from those now.
  template <class I, class T>
  CDEM_HD void gather_means_before(I p, Real step, const Vec3<T>* mean, Vec3<T>* before) const {
    for (Index k = 0; k < count; ++k) {
      const Vec3<T> both =
          nodes.velocity(pair_nodes.at(k, p)) + nodes.velocity(pair_nodes.at(count + k, p));
      before[k] = mean[k] - T(0.5 * step) * both;
    }
  }
  template <class I>
  CDEM_HD BondSpring<Number<I>> spring(I p) const {
    return pairs.spring(p, pairs.area.at(0, p) / Number<I>(Real(count)));
  }
  /// Forces on the mates from those at the bond points: calls `use` with the number of a vertex and
  /// its force  [N].
  template <class T, class Use>
  CDEM_HD void move_to_vertices(const Vec3<T>* force, const Use& use) const {
    const T own(1.0 - indentation), shared(indentation / count), zero(0.0);
    Vec3<T> sum{zero, zero, zero};
    for (Index k = 0; k < count; ++k) sum = sum + force[k];
    for (Index k = 0; k < count; ++k) use(k, own * force[k] + shared * sum);
  }

 private:
  /// The common case: all points of the pair were intact and stay so.
  template <class Laws, class I, class T>
  CDEM_HD auto all_bear(I p, const Frame<T>& frame, const Vec3<T>* jump, Vec3<T>* force) const {
    const auto laws = pairs.template laws<Laws>(p);
    const BondSpring<T> own = spring(p);
    auto all = pairs.bond.at(0, p) > T(0.5);
    for (Index k = 1; k < count; ++k) all = all & (pairs.bond.at(k, p) > T(0.5));
    for (Index k = 0; k < count; ++k) {
      T state[Laws::most_state + 1];
      pairs.load_history<Laws>(p, k, count, state);
      all = all & bears(laws, own, frame, jump[k], state, force[k]);
    }
    return all;
  }
  template <class Laws, class I, class M, class T>
  CDEM_HD void update_history(I p, const M& live, const Frame<T>& frame, const Vec3<T>* jump,
                              Vec3<T>* force) const {
    const T zero(0.0);
    const auto laws = pairs.template laws<Laws>(p);
    const BondSpring<T> own = spring(p);
    const auto open = pairs.are_hinges(p);
    Vec3<T> rate[count];
    gather_rates(p, rate);
    BondForce<T> total{.on_b = {zero, zero, zero},
                       .stored = zero,
                       .fracture = zero,
                       .friction = zero,
                       .tension = zero,
                       .shear = zero};
    T widest(0.0), intact(0.0);
    for (Index k = 0; k < count; ++k) {
      const BondHistory<T> old = pairs.history_of(p, k);
      BondHistory<T> h = old;
      T state[Laws::most_state + 1];
      pairs.load_history<Laws>(p, k, count, state);
      const BondForce<T> f =
          bond_force(laws, own, frame, jump[k], jump[k] - T(dt) * rate[k], dt, open, h, state);
      // a released pair beside live ones in a lane keeps its history as it was
      pairs.store_history<Laws>(p, k, count, live, state);
      pairs.set_history(p, k, live, old, h);
      force[k] = f.on_b;
      widest = max_of(widest, dot(jump[k], jump[k]));
      intact += h.bond;
      total.stored += f.stored;
      total.fracture += f.fracture;
      total.friction += f.friction;
      total.tension += f.tension;
      total.shear += f.shear;
    }
    pairs.note_jump(p, live & (!(intact > zero)), sqrt_of(widest));
    pairs.stored.set(0, p, select(live, total.stored, zero));
    add(pairs.fracture, p, select(live, total.fracture, zero));
    add(pairs.friction, p, select(live, total.friction, zero));
    add(pairs.broken_tension, p, select(live, total.tension, zero));
    add(pairs.broken_shear, p, select(live, total.shear, zero));
  }
  template <class I, class M, class T>
  CDEM_HD void write_forces(I p, const M& live, const Vec3<T>* force) const {
    move_to_vertices(force, [&](Index k, const Vec3<T>& of_vertex) {
      const T zero(0.0);
      corner_force.set(p, count, k, select(live, of_vertex, Vec3<T>{zero, zero, zero}));
    });
  }
  template <class I>
  CDEM_HD static void add(InOutTable table, I p, Number<I> more) {
    table.set(0, p, table.at(0, p) + more);
  }
};

/// Bonds of touching faces that do not conform: one point per vertex of their overlap polygon. Run
/// by WithLaws.
struct OverlapBonds {
  FaceColumns faces;
  const Index* pair_faces;   // [pair][2]
  const Index* point_first;  // [pair + 1]
  const Real* weights_a;     // [point][4] on the first face's vertices
  const Real* weights_b;     // [point][4] on the second's
  const Real* point_area;    // [point]  [m2]
  PairColumns pairs;         // bond, slip1, slip2, history are [.][point] here
  OutForces corner_force;    // [pair][8]: four vertices of either face

  template <class Laws>
  CDEM_HD void update(One p) const {
    if (!pairs.are_live(p)) return;
    const auto laws = pairs.template laws<Laws>(p);
    const Index a = pair_faces[2 * p.i], b = pair_faces[2 * p.i + 1];
    const Vec3<Real> none{0.0, 0.0, 0.0};
    Vec3<Real> force[8] = {none, none, none, none, none, none, none, none};
    const Frame<Real> frame = frame_of(a, b);
    const bool open = pairs.are_hinges(p);
    Real widest = 0, intact = 0, stored = 0, fracture = 0, friction = 0, tension = 0, shear = 0;
    for (Index c = point_first[p.i]; c < point_first[p.i + 1]; ++c) {
      const One point{c};
      const Vec3<Real> jump = jump_at(a, b, frame, c);
      const Vec3<Real> rate = rate_of_jump(a, b, c);
      const BondHistory<Real> old = pairs.history_of(point, 0);
      BondHistory<Real> h = old;
      Real state[Laws::most_state + 1];
      pairs.load_history<Laws>(point, 0, 1, state);
      const BondForce<Real> f = bond_force(laws, pairs.spring(p, point_area[c]), frame, jump,
                                           jump - faces.dt * rate, faces.dt, open, h, state);
      pairs.store_history<Laws>(point, 0, 1, true, state);
      pairs.set_history(point, 0, true, old, h);
      for (Index k = 0; k < 4; ++k) {
        force[k] = force[k] - weights_a[4 * c + k] * f.on_b;
        force[4 + k] = force[4 + k] + weights_b[4 * c + k] * f.on_b;
      }
      widest = max_of(widest, norm(jump));
      intact += h.bond;
      stored += f.stored, fracture += f.fracture, friction += f.friction;
      tension += f.tension, shear += f.shear;
    }
    for (Index k = 0; k < 8; ++k) corner_force.set(p, 8, k, force[k]);
    pairs.note_jump(p, !(intact > 0), widest);
    pairs.stored.set(0, p, stored);
    pairs.fracture.set(0, p, pairs.fracture.at(0, p) + fracture);
    pairs.friction.set(0, p, pairs.friction.at(0, p) + friction);
    pairs.broken_tension.set(0, p, pairs.broken_tension.at(0, p) + tension);
    pairs.broken_shear.set(0, p, pairs.broken_shear.at(0, p) + shear);
  }

  /// Jump of displacement at a bond point that strains its spring  [m].
  CDEM_HD Vec3<Real> jump_at(Index a, Index b, const Frame<Real>& frame, Index c) const {
    return pairs.past_rest(One{c}, 0, 1, frame, distance(a, b, c));
  }
  /// x_b - x_a at a bond point  [m].
  CDEM_HD Vec3<Real> distance(Index a, Index b, Index c) const {
    return at(b, weights_b, c) - at(a, weights_a, c);
  }
  CDEM_HD Vec3<Real> position(Index a, Index c) const { return at(a, weights_a, c); }
  /// Rate of the jump at a bond point  [m/s].
  CDEM_HD Vec3<Real> rate_of_jump(Index a, Index b, Index c) const {
    return rate_at(b, weights_b, c) - rate_at(a, weights_a, c);
  }
  CDEM_HD Frame<Real> frame_of(Index a, Index b) const {
    const Frame<Real> f = faces.shape(a).frame();
    const Vec3<Real> n = unit(f.n - faces.shape(b).normal());
    const Vec3<Real> t1 = unit(f.t1 - dot(n, f.t1) * n);
    return {n, t1, cross(n, t1)};
  }

 private:
  CDEM_HD Vec3<Real> at(Index face, const Real* weights, Index c) const {
    Vec3<Real> sum{0.0, 0.0, 0.0};
    for (Index k = 0; k < faces.vertex_count(face); ++k)
      sum = sum + weights[4 * c + k] * faces.nodes.position(faces.vertex(face, k));
    return sum;
  }
  CDEM_HD Vec3<Real> rate_at(Index face, const Real* weights, Index c) const {
    Vec3<Real> sum{0.0, 0.0, 0.0};
    for (Index k = 0; k < faces.vertex_count(face); ++k)
      sum = sum + weights[4 * c + k] * faces.nodes.velocity(faces.vertex(face, k));
    return sum;
  }
};

}  // namespace cdem
