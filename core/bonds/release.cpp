// release.cpp - see release.hpp.
#include "core/bonds/release.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/base/primitives.hpp"
#include "core/bonds/broken_pairs.hpp"
#include "core/bonds/transfer_to_contact.hpp"
#include "core/bonds/views.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// A pair whose points are all broken has its faces released once they have moved apart or along
/// each other by this part of the indentation; by the whole indentation, at once.
constexpr Real release_part = 0.1;

HasMovedFar has_moved_by(const Model& m, const PairSet& p, const PairState& s, Real part) {
  return {.part = part,
          .status = s.status.data(),
          .jump = s.jump.data(),
          .faces = p.faces.data(),
          .face_length = m.face_length.data()};
}

bool has_moved_far(const Model& m, const PairSet& p, const PairState& s) {
  return any_item({}, p.count, HasJumped{{s.jump.data(), 0}}) &&
         any_item({}, p.count, has_moved_by(m, p, s, m.rules.indentation));
}

/// The pairs for which a kernel holds, ascending.
template <class Kernel>
Column<Index> pairs_where(const PairSet& p, const Kernel& kernel) {
  Column<Index> list;
  select_items({}, p.count, kernel, list);
  return list;
}

/// A pair that holds by some of its points and is this part of its length apart at another is a
/// hinge: bodies between its faces touch them.
constexpr Real hinge_part = 0.05;

HoldsInPart holds_in_part(const PairSet& p, const PairState& s) {
  return {.status = s.status.data(),
          .bond = s.bond.data(),
          .point_first = conforms(p) ? nullptr : p.point_first.data(),
          .points = p.points,
          .stride = p.point_stride};
}

/// A broken point of a pair that may be a hinge.
struct BrokenPoint {
  std::size_t place;  // in the point tables
  Vec3<Real> jump;
  BondSpring<Real> spring;
  Real history[InterfaceLaws::most_state + 1];
};

/// If a pair has opened as a hinge, list it. Its broken points carry nothing any more; their small
/// energy is lost to friction.
void open_if_hinge(const Model& m, const PairSet& p, PairState& ps, Index i,
                   const Frame<Real>& frame, std::vector<BrokenPoint>& broken,
                   std::vector<Index>& hinges) {
  Real widest = 0;
  for (const BrokenPoint& point : broken) widest = std::max(widest, norm(point.jump));
  if (!(widest > hinge_part * pair_length(m, p, i))) return;
  const PairColumns pairs = on_host(pair_columns(m, p, ps));
  const auto slip1 = on_host(ps.slip1), slip2 = on_host(ps.slip2);
  const auto friction = on_host(ps.friction), stored = on_host(ps.stored);
  for (BrokenPoint& point : broken) {
    const JointInput<Real> in =
        point.spring.input(frame, point.jump, {0.0, slip1[point.place], slip2[point.place]});
    const JointAnswer<Real> joint = pairs.laws<InterfaceLaws>(One{i}).respond(in, point.history);
    const Real held = point.spring.area * (joint.stored_n + joint.stored_s);
    friction[i] += held;
    stored[i] -= held;
  }
  on_host(ps.status)[i] = Flag(PairStatus::hinge);
  hinges.push_back(i);
}

/// Returns the pairs that have opened as hinges.
template <Index count>
std::vector<Index> open_hinges(const Model& m, State& s, const PairSet& p, PairState& ps,
                               Real indentation) {
  std::vector<Index> hinges;
  const std::vector<Index> some = fetch(pairs_where(p, holds_in_part(p, ps)));
  const auto bonds = on_host(ConformingBonds<count>{.nodes = {s.nodes.motion.data()},
                                                    .pair_nodes = {p.nodes.data(), p.stride},
                                                    .pairs = pair_columns(m, p, ps),
                                                    .indentation = indentation,
                                                    .dt = 0,
                                                    .sampled = false,
                                                    .corner_force = {}});
  const auto bond = on_host(ps.bond);
  std::vector<BrokenPoint> broken;
  for (const Index i : some) {
    const auto place = [&](Index k) { return std::size_t(k) * p.point_stride + i; };
    Vec3<Real> jump[count];
    const Frame<Real> frame = bonds.gather_jumps(One{i}, jump);
    broken.clear();
    for (Index k = 0; k < count; ++k) {
      if (bond[place(k)] > 0) continue;
      broken.push_back({place(k), jump[k], bonds.spring(One{i}), {}});
      bonds.pairs.template load_history<InterfaceLaws>(One{i}, k, count, broken.back().history);
    }
    open_if_hinge(m, p, ps, i, frame, broken, hinges);
  }
  return hinges;
}

std::vector<Index> open_overlap_hinges(const Model& m, State& s) {
  std::vector<Index> hinges;
  const PairSet& p = m.overlaps;
  PairState& ps = s.overlaps;
  const std::vector<Index> some = fetch(pairs_where(p, holds_in_part(p, ps)));
  const OverlapBonds bonds = on_host(overlap_bonds(m, s));
  const auto point_first = on_host(p.point_first), faces = on_host(p.faces);
  const auto point_area = on_host(p.point_area);
  const auto bond = on_host(ps.bond);
  std::vector<BrokenPoint> broken;
  for (const Index i : some) {
    const Index first = point_first[i], count = point_first[i + 1] - first;
    const Index a = faces[2 * i], b = faces[2 * i + 1];
    const Frame<Real> frame = bonds.frame_of(a, b);
    broken.clear();
    for (Index c = first; c < first + count; ++c) {
      if (bond[c] > 0) continue;
      broken.push_back({std::size_t(c),
                        bonds.jump_at(a, b, frame, c),
                        bonds.pairs.spring(One{i}, point_area[c]),
                        {}});
      bonds.pairs.load_history<InterfaceLaws>(One{c}, 0, 1, broken.back().history);
    }
    open_if_hinge(m, p, ps, i, frame, broken, hinges);
  }
  return hinges;
}

/// Pairs of one set whose faces can be touched from now on.
struct LetGo {
  const PairSet& set;
  PairState& state;
  std::vector<Index> hinges;
  Column<Index> released;
};

/// The released pairs of a set with these new hinges.
LetGo let_go(const Model& m, const PairSet& p, PairState& ps, std::vector<Index> hinges) {
  const HasMovedFar has_moved = has_moved_by(m, p, ps, release_part * m.rules.indentation);
  return {
      .set = p, .state = ps, .hinges = std::move(hinges), .released = pairs_where(p, has_moved)};
}

void expose_faces(const Model& m, State& s, const std::array<LetGo, 3>& sets) {
  Column<Flag> open = open_faces(s);
  for (const LetGo& one : sets) {
    Column<Index> hinges;
    hinges.assign(one.hinges);
    open_faces_of(one.set, hinges, open);
    open_faces_of(one.set, one.released, open);
  }
  renew_exposed(m, s, open);
}

/// Contacts take over what released pairs of a set carry.
void hand_over(const Model& m, State& s, const LetGo& pairs) {
  const PairSet& p = pairs.set;
  PairState& ps = pairs.state;
  const auto status = on_host(ps.status);
  const auto stored = on_host(ps.stored), friction = on_host(ps.friction);
  const auto jump = on_host(ps.jump), jump_at_break = on_host(ps.jump_at_break);
  for (const Index i : fetch(pairs.released)) {
    give_history(m, s, p, ps, i);
    const bool hinge = PairStatus(status[i]) == PairStatus::hinge;
    if (p.point_first.size() > 0 && !hinge) {
      s.released_overlaps.resize(s.released_overlaps.size() + 1, i);
    } else {
      if (!hinge) stored[i] -= transfer_to_contact(m, s, p, ps, i);
      friction[i] += stored[i];
      stored[i] = 0;
      clear_corner_rows(s, p, i);
    }
    status[i] = Flag(PairStatus::released);
    jump[i] = 0;
    jump_at_break[i] = -1;
  }
}

}  // namespace

bool release_is_due(const Model& m, const State& s) {
  return has_moved_far(m, m.triangles, s.triangles) || has_moved_far(m, m.quads, s.quads) ||
         has_moved_far(m, m.overlaps, s.overlaps);
}

bool release_bonds(const Model& m, State& s) {
  const std::array<LetGo, 3> sets{
      let_go(m, m.triangles, s.triangles,
             open_hinges<3>(m, s, m.triangles, s.triangles, m.bond_indentation_triangle)),
      let_go(m, m.quads, s.quads, open_hinges<4>(m, s, m.quads, s.quads, m.bond_indentation_quad)),
      let_go(m, m.overlaps, s.overlaps, open_overlap_hinges(m, s))};
  bool hinges = false, released = false;
  for (const LetGo& one : sets) {
    hinges = hinges || !one.hinges.empty();
    released = released || one.released.size() > 0;
  }
  if (hinges || released) expose_faces(m, s, sets);
  for (const LetGo& one : sets)
    for (const Index i : one.hinges) give_history(m, s, one.set, one.state, i);
  for (const LetGo& one : sets) hand_over(m, s, one);
  return released;
}

}  // namespace cdem
