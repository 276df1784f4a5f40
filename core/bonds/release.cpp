// release.cpp - see release.hpp.
#include "core/bonds/release.hpp"

#include <algorithm>
#include <vector>

#include "core/base/primitives.hpp"
#include "core/bonds/has_jumped.hpp"
#include "core/bonds/lets_go.hpp"
#include "core/bonds/transfer_to_contact.hpp"
#include "core/bonds/views.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

PairStatus status_of(const PairState& s, Index pair) { return PairStatus(s.status[pair]); }

/// A pair whose points are all broken has its faces released once they have moved apart or along
/// each other by this part of the indentation; by the whole indentation, at once.
constexpr Real release_part = 0.1;

LetsGo lets_go(const Model& m, const PairSet& p, const PairState& s, Real part) {
  return {.part = part,
          .status = s.status.data(),
          .jump = s.jump.data(),
          .stored = s.stored.data(),
          .faces = p.faces.data(),
          .interface = p.interface.data(),
          .face_length = m.face_length.data(),
          .interfaces = interface_table(m)};
}

bool has_moved_far(const Model& m, const PairSet& p, const PairState& s) {
  return any_item({}, p.count, HasJumped{{s.jump.data(), 0}}) &&
         any_item({}, p.count, lets_go(m, p, s, m.rules.indentation));
}

/// The pairs for which a kernel holds, ascending.
template <class Kernel>
std::vector<Index> pairs_where(const PairSet& p, const Kernel& kernel) {
  Column<Index> list;
  select_items({}, p.count, kernel, list);
  return fetch(list);
}

/// A pair that holds by some of its points and is this part of its length apart at another is a
/// hinge: what comes between its faces touches them.
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

/// If a pair has opened as a hinge, expose its faces. Its broken points carry nothing any more;
/// what little those held is lost to friction.
void open_if_hinge(const Model& m, State& s, const PairSet& p, PairState& ps, Index i,
                   const Frame<Real>& frame, std::vector<BrokenPoint>& broken) {
  Real widest = 0;
  for (const BrokenPoint& point : broken) widest = std::max(widest, norm(point.jump));
  if (!(widest > hinge_part * pair_length(m, p, i))) return;
  const PairColumns pairs = pair_columns(m, p, ps);
  for (BrokenPoint& point : broken) {
    const JointInput<Real> in =
        point.spring.input(frame, point.jump, {0.0, ps.slip1[point.place], ps.slip2[point.place]});
    const JointAnswer<Real> joint = pairs.laws<InterfaceLaws>(One{i}).respond(in, point.history);
    const Real held = point.spring.area * (joint.stored_n + joint.stored_s);
    ps.friction[i] += held;
    ps.stored[i] -= held;
  }
  ps.status[i] = Flag(PairStatus::hinge);
  expose(s, p.faces[2 * i]);
  expose(s, p.faces[2 * i + 1]);
  give_history(m, s, p, ps, i);
}

template <Index count>
void open_hinges(const Model& m, State& s, const PairSet& p, PairState& ps, Real indentation) {
  const ConformingBonds<count> bonds{.nodes = {s.nodes.motion.data()},
                                     .pair_nodes = {p.nodes.data(), p.stride},
                                     .pairs = pair_columns(m, p, ps),
                                     .indentation = indentation,
                                     .dt = 0,
                                     .sampled = false,
                                     .corner_force = {}};
  std::vector<BrokenPoint> broken;
  for (const Index i : pairs_where(p, holds_in_part(p, ps))) {
    const auto place = [&](Index k) { return std::size_t(k) * p.point_stride + i; };
    Vec3<Real> jump[count];
    const Frame<Real> frame = bonds.gather_jumps(One{i}, jump);
    broken.clear();
    for (Index k = 0; k < count; ++k) {
      if (ps.bond[place(k)] > 0) continue;
      broken.push_back({place(k), jump[k], bonds.spring(One{i}), {}});
      bonds.pairs.template load_history<InterfaceLaws>(One{i}, k, count, broken.back().history);
    }
    open_if_hinge(m, s, p, ps, i, frame, broken);
  }
}

void open_overlap_hinges(const Model& m, State& s) {
  const PairSet& p = m.overlaps;
  PairState& ps = s.overlaps;
  const OverlapBonds bonds = overlap_bonds(m, s);
  std::vector<BrokenPoint> broken;
  for (const Index i : pairs_where(p, holds_in_part(p, ps))) {
    const Index first = p.point_first[i], count = p.point_first[i + 1] - first;
    const Index a = p.faces[2 * i], b = p.faces[2 * i + 1];
    const Frame<Real> frame = bonds.frame_of(a, b);
    broken.clear();
    for (Index c = first; c < first + count; ++c) {
      if (ps.bond[c] > 0) continue;
      broken.push_back({std::size_t(c),
                        bonds.jump_at(a, b, frame, c),
                        bonds.pairs.spring(One{i}, p.point_area[c]),
                        {}});
      bonds.pairs.load_history<InterfaceLaws>(One{c}, 0, 1, broken.back().history);
    }
    open_if_hinge(m, s, p, ps, i, frame, broken);
  }
}

/// Returns whether any was released.
bool release_pairs(const Model& m, State& s, const PairSet& p, PairState& ps) {
  const std::vector<Index> released =
      pairs_where(p, lets_go(m, p, ps, release_part * m.rules.indentation));
  for (const Index i : released) {
    expose(s, p.faces[2 * i]);
    expose(s, p.faces[2 * i + 1]);
    give_history(m, s, p, ps, i);
    const bool hinge = status_of(ps, i) == PairStatus::hinge;
    if (p.point_first.size() > 0 && !hinge) {
      s.released_overlaps.push(i);
    } else {
      if (!hinge) ps.stored[i] -= transfer_to_contact(m, s, p, ps, i);
      ps.friction[i] += ps.stored[i];
      ps.stored[i] = 0;
    }
    ps.status[i] = Flag(PairStatus::released);
    ps.jump[i] = 0;
    ps.jump_at_break[i] = -1;
  }
  return !released.empty();
}

}  // namespace

bool release_is_due(const Model& m, const State& s) {
  return has_moved_far(m, m.triangles, s.triangles) || has_moved_far(m, m.quads, s.quads) ||
         has_moved_far(m, m.overlaps, s.overlaps);
}

bool release_bonds(const Model& m, State& s) {
  open_hinges<3>(m, s, m.triangles, s.triangles, m.bond_indentation_triangle);
  open_hinges<4>(m, s, m.quads, s.quads, m.bond_indentation_quad);
  open_overlap_hinges(m, s);
  const bool triangles = release_pairs(m, s, m.triangles, s.triangles);
  const bool quads = release_pairs(m, s, m.quads, s.quads);
  const bool overlaps = release_pairs(m, s, m.overlaps, s.overlaps);
  return triangles || quads || overlaps;
}

}  // namespace cdem
