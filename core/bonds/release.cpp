// release.cpp - see release.hpp.
#include "core/bonds/release.hpp"

#include <array>
#include <utility>

#include "core/base/primitives.hpp"
#include "core/bonds/broken_pairs.hpp"
#include "core/bonds/hinges.hpp"
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
          .jump = {s.jump.data(), p.stride},
          .lengths = pair_lengths(m, p)};
}

/// The pairs for which a kernel holds, ascending.
template <class Kernel>
Column<Index> pairs_where(const PairSet& p, const Kernel& kernel) {
  Column<Index> list;
  select_items({}, p.count, kernel, list);
  return list;
}

HoldsInPart holds_in_part(const PairSet& p, const PairState& s) {
  return {.status = s.status.data(),
          .bond = s.bond.data(),
          .point_first = conforms(p) ? nullptr : p.point_first.data(),
          .points = p.points,
          .stride = p.point_stride};
}

/// Open the pairs that have become hinges; returns them.
template <class Points>
Column<Index> open_hinges(const Model& m, const PairSet& p, PairState& ps, const Points& points) {
  const OpensAsHinge<Points> opens{holds_in_part(p, ps), points, pair_lengths(m, p)};
  Column<Index> hinges = pairs_where(p, opens);
  for_each_item({}, Index(hinges.size()),
                OpenHinge<Points>{hinges.data(), points, ps.status.data()});
  return hinges;
}

/// Pairs of one set whose faces can be touched from now on.
struct LetGo {
  const PairSet& set;
  PairState& state;
  Column<Index> hinges, released;
};

/// The released pairs of a set with these new hinges.
LetGo let_go(const Model& m, const PairSet& p, PairState& ps, Column<Index> hinges) {
  const HasMovedFar has_moved = has_moved_by(m, p, ps, release_part * m.rules.indentation);
  return {
      .set = p, .state = ps, .hinges = std::move(hinges), .released = pairs_where(p, has_moved)};
}

void expose_faces(const Model& m, State& s, const std::array<LetGo, 3>& sets) {
  Column<Flag> open = open_faces(s);
  for (const LetGo& one : sets) {
    open_faces_of(one.set, one.hinges, open);
    open_faces_of(one.set, one.released, open);
  }
  renew_exposed(m, s, open);
}

}  // namespace

void ask_if_release_is_due(const Model& m, const State& s, Flag* answer) {
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    raise_if_any({}, p.count, has_moved_by(m, p, ps, m.rules.indentation), answer);
  });
}

bool release_bonds(const Model& m, State& s) {
  const auto let_go_of = [&](const PairSet& p, PairState& ps, const auto& points) {
    return let_go(m, p, ps, open_hinges(m, p, ps, points));
  };
  const std::array<LetGo, 3> sets{
      let_go_of(m.triangles, s.triangles,
                BrokenOfConforming<3>{conforming_bonds<3>(m, s, m.triangles, s.triangles)}),
      let_go_of(m.quads, s.quads,
                BrokenOfConforming<4>{conforming_bonds<4>(m, s, m.quads, s.quads)}),
      let_go_of(m.overlaps, s.overlaps, BrokenOfOverlaps{overlap_bonds(m, s)})};
  bool hinges = false, released = false;
  for (const LetGo& one : sets) {
    hinges = hinges || one.hinges.size() > 0;
    released = released || one.released.size() > 0;
  }
  if (hinges || released) expose_faces(m, s, sets);
  for (const LetGo& one : sets) give_history(m, s, one.set, one.state, one.hinges);
  for (const LetGo& one : sets) transfer_to_contact(m, s, one.set, one.state, one.released);
  return released;
}

}  // namespace cdem
