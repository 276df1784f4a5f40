// release.cpp - see release.hpp.
#include "core/bonds/release.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/bonds/transfer_to_contact.hpp"
#include "core/bonds/views.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"

namespace cdem {

namespace {

/// A pair whose points are all broken has its faces released once they have moved apart or along
/// each other by this part of the indentation; by the whole indentation, at once.
constexpr Real release_part = 0.1;

bool has_moved_far(const Model& m, const PairSet& p, const PairState& s) {
  bool due = false;
#pragma omp parallel for schedule(static) reduction(|| : due) if (p.count >= worth_threads)
  for (Index i = 0; i < p.count; ++i)
    due = due || (s.jump[i] > 0 && s.jump[i] > m.rules.indentation * pair_length(m, p, i));
  return due;
}

/// A pair that holds by some of its points and is this part of its length apart at another is a
/// hinge: what comes between its faces touches them.
constexpr Real hinge_part = 0.05;

/// Expose the faces of conforming pairs that have opened as hinges. Their broken points carry
/// nothing any more; what little those held is lost to friction.
template <Index count>
void open_hinges(const Model& m, State& s, const PairSet& p, PairState& ps, Real indentation) {
  const ConformingBonds<count> bonds{.nodes = {s.nodes.motion.data()},
                                     .pair_nodes = {p.nodes.data(), p.stride},
                                     .pairs = pair_columns(m, p, ps),
                                     .indentation = indentation,
                                     .dt = 0,
                                     .sampled = false,
                                     .corner_force = {}};
  for (Index i = 0; i < p.count; ++i) {
    const auto point = [&](Index k) { return std::size_t(k) * p.point_stride + i; };
    const auto holds = [&](Index k) { return ps.bond[point(k)] > 0; };
    Index holding = 0;
    for (Index k = 0; k < count; ++k) holding += holds(k);
    if (ps.live[i] != 1 || holding == 0 || holding == count) continue;
    Vec3<Real> mean[count], jump[count];
    bonds.gather_jumps(One{i}, mean, jump);
    Real widest = 0;
    for (Index k = 0; k < count; ++k)
      if (!holds(k)) widest = std::max(widest, norm(jump[k]));
    if (!(widest > hinge_part * pair_length(m, p, i))) continue;
    const Frame<Real> frame = pair_frame<count>(mean);
    const BondSpring<Real> spring = bonds.spring(One{i});
    for (Index k = 0; k < count; ++k) {
      if (holds(k)) continue;
      Real state[InterfaceLaws::most_state + 1];
      bonds.pairs.load_history(One{i}, k, count, state);
      const JointAnswer<Real> joint =
          respond(bonds.pairs.interfaces, p.interface[i],
                  spring.input(frame, jump[k], 0.0, ps.slip1[point(k)], ps.slip2[point(k)]), state);
      const Real held = spring.area * (joint.stored_n + joint.stored_s);
      ps.friction[i] += held;
      ps.stored[i] -= held;
    }
    ps.live[i] = 2;
    expose(s, p.faces[2 * i]);
    expose(s, p.faces[2 * i + 1]);
    give_history(m, s, p, ps, i);
  }
}

/// Returns whether any was released.
bool release_pairs(const Model& m, State& s, const PairSet& p, PairState& ps) {
  bool any = false;
  for (Index i = 0; i < p.count; ++i) {
    if (!(ps.live[i] > 0)) continue;
    if (!(ps.jump[i] > release_part * m.rules.indentation * pair_length(m, p, i))) continue;
    expose(s, p.faces[2 * i]);
    expose(s, p.faces[2 * i + 1]);
    give_history(m, s, p, ps, i);
    if (p.point_first.size() > 0) {
      s.released_overlaps.push(i);
    } else {
      if (ps.live[i] == 1) ps.stored[i] -= transfer_to_contact(m, s, p, ps, i);
      ps.friction[i] += ps.stored[i];
      ps.stored[i] = 0;
    }
    ps.live[i] = ps.jump[i] = 0;
    ps.jump_at_break[i] = -1;
    any = true;
  }
  return any;
}

}  // namespace

bool release_is_due(const Model& m, const State& s) {
  return has_moved_far(m, m.triangles, s.triangles) || has_moved_far(m, m.quads, s.quads) ||
         has_moved_far(m, m.overlaps, s.overlaps);
}

bool release_bonds(const Model& m, State& s) {
  open_hinges<3>(m, s, m.triangles, s.triangles, m.bond_indentation_triangle);
  open_hinges<4>(m, s, m.quads, s.quads, m.bond_indentation_quad);
  const bool triangles = release_pairs(m, s, m.triangles, s.triangles);
  const bool quads = release_pairs(m, s, m.quads, s.quads);
  const bool overlaps = release_pairs(m, s, m.overlaps, s.overlaps);
  return triangles || quads || overlaps;
}

}  // namespace cdem
