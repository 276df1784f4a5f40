// initial_tractions.cpp - see initial_tractions.hpp.
#include "core/bonds/initial_tractions.hpp"

#include <algorithm>

#include "core/bonds/views.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/init_state.hpp"

namespace cdem {

namespace {

/// A bond point, with the frame and the spring of its pair.
struct Point {
  BondPlace at;
  Vec3<Real> jump;  // past nothing
  Frame<Real> frame;
  BondSpring<Real> spring;
  Index pair, interface;
  std::size_t place, row;  // in the point tables, and the numbers from axis to axis of `rest`
};

template <Index count, class Visit>
void visit_points(PairKind<ConformingBonds<count>>, const Model& m, State& s, const PairSet& p,
                  PairState& ps, Visit&& visit) {
  const auto bonds = on_host(conforming_bonds<count>(m, s, p, ps));
  const auto faces = on_host(p.faces), interface = on_host(p.interface);
  // (1 - a) (1 - b) = 1/4 and 1/3: the mass matrix of the face equals that of the points at a and b
  const Real place_of_stress = 1 - 1.0 / (count == 3 ? 4 : 3) / (1 - bonds.indentation);
  for (Index i = 0; i < p.count; ++i) {
    Vec3<Real> mean[count], jump[count];
    bonds.gather_vertices(One{i}, mean, jump);
    const Frame<Real> frame = pair_frame<count>(mean);
    move_inside<count>(place_of_stress, mean);
    move_inside<count>(bonds.indentation, jump);
    for (Index k = 0; k < count; ++k)
      visit(Point{.at = {mean[k], {faces[2 * i], faces[2 * i + 1]}},
                  .jump = jump[k],
                  .frame = frame,
                  .spring = bonds.spring(One{i}),
                  .pair = i,
                  .interface = interface[i],
                  .place = std::size_t(k) * p.point_stride + i,
                  .row = std::size_t(count) * p.point_stride});
  }
}

template <class Visit>
void visit_points(PairKind<OverlapBonds>, const Model& m, State& s, const PairSet& p, PairState&,
                  Visit&& visit) {
  const OverlapBonds bonds = on_host(overlap_bonds(m, s));
  const auto faces = on_host(p.faces), interface = on_host(p.interface);
  const auto first = on_host(p.point_first);
  const auto area = on_host(p.point_area);
  for (Index i = 0; i < p.count; ++i) {
    const Index a = faces[2 * i], b = faces[2 * i + 1];
    for (Index c = first[i]; c < first[i + 1]; ++c)
      visit(Point{.at = {bonds.position(a, c), {a, b}},
                  .jump = bonds.distance(a, b, c),
                  .frame = bonds.frame_of(a, b),
                  .spring = bonds.pairs.spring(One{i}, area[c]),
                  .pair = i,
                  .interface = interface[i],
                  .place = std::size_t(c),
                  .row = std::size_t(p.point_stride)});
  }
}

/// Answer of the law for a bond point strained by minus its rest.
JointAnswer<Real> answer_at(const PairColumns& pairs, const Point& point, const Vec3<Real>& rest,
                            Real bond) {
  Real state[InterfaceLaws::most_state + 1] = {};
  InterfaceLaws::for_each([&]<template <class> class Law, Index number>() {
    if (pairs.interfaces.law_of(point.interface) == number)
      for (Index k = 0; k < state_count<Law>; ++k)
        state[k] = bond > 0 ? Law<Real>::state[k].intact : Law<Real>::state[k].loose;
  });
  const Vec3<Real> jump =
      -rest.x * point.frame.n - rest.y * point.frame.t1 - rest.z * point.frame.t2;
  return pairs.laws<InterfaceLaws>(One{point.pair})
      .respond(point.spring.input(point.frame, jump, {bond, 0.0, 0.0}), state);
}

}  // namespace

std::vector<BondPlace> bond_places(const Model& m, State& s) {
  std::vector<BondPlace> places;
  for_each_pair_set(m, s, [&](auto kind, const PairSet& p, PairState& ps) {
    visit_points(kind, m, s, p, ps, [&](const Point& point) { places.push_back(point.at); });
  });
  return places;
}

CutTractions set_initial_tractions(Model& m, State& s, const Real* stress, const Flag* bonded) {
  CutTractions cut;
  Real lift = 0;
  const auto face_stiffness = on_host(m.face_stiffness);
  const auto load = [&](const PairColumns& pairs, const OnHost<Real>& rest, const Point& point) {
    const JointStiffness<Real>& k = point.spring.stiffness;
    const Frame<Real>& f = point.frame;
    const Sym3<Real> of_rock{.xx = stress[0],
                             .yy = stress[1],
                             .zz = stress[2],
                             .xy = stress[3],
                             .yz = stress[4],
                             .zx = stress[5]};
    stress += 6;
    const Vec3<Real> t = full(of_rock) * f.n;
    const Vec3<Real> wanted{-dot(t, f.n), -dot(t, f.t1), -dot(t, f.t2)};
    const Real bond = bonded[point.interface] ? 1 : 0;
    const auto depth = [&](Real pressure, const JointStiffness<Real>& spring) {
      return depth_under(pairs.interfaces, point.interface, pressure, spring);
    };
    const JointAnswer<Real> joint =
        answer_at(pairs, point, {depth(wanted.x, k), wanted.y / k.s, wanted.z / k.s}, bond);
    const Vec3<Real> borne{joint.elastic, joint.shear1, joint.shear2};
    const Real lost = norm(wanted - borne);
    if (lost > 1e-9 * norm(wanted)) {
      ++cut.count;
      if (lost > cut.most) cut.most = lost, cut.face = point.at.faces[0];
    }
    rest[point.place] = depth(borne.x, k);
    rest[point.place + point.row] = borne.y / k.s;
    rest[point.place + 2 * point.row] = borne.z / k.s;
    pairs.bond.data[point.place] = joint.bond;
    const Interface& contact = pairs.interfaces.interfaces[point.interface];
    const Real side_a = face_stiffness[point.at.faces[0]],
               side_b = face_stiffness[point.at.faces[1]];
    lift = std::max(lift,
                    depth(borne.x, JointStiffness<Real>::of(contact.stiffness_n(side_a, side_b),
                                                            contact.stiffness_s(side_a, side_b))));
  };
  for_each_pair_set(m, s, [&](auto kind, const PairSet& p, PairState& ps) {
    const PairColumns pairs = on_host(pair_columns(m, p, ps));
    const auto rest = on_host(ps.rest);
    visit_points(kind, m, s, p, ps, [&](const Point& point) { load(pairs, rest, point); });
  });
  // contacts are kept to twice their lift; those of a pair are fewer than its points, so that one
  // may have to carry the forces of several
  constexpr Real fewer = 4;
  m.rules.lifted += fewer * 2 * lift - m.initial_lift;
  m.initial_lift = fewer * 2 * lift;
  return cut;
}

namespace {

/// Pairs of a set that are bonded again.
std::vector<Flag> pairs_to_bond(const Model& m, const State& s, const PairSet& p,
                                const Flag* comes) {
  const auto faces = on_host(p.faces), face_nodes = on_host(m.face_nodes);
  const auto out = on_host(s.nodes.out);
  std::vector<Flag> some(p.count);
  for (Index i = 0; i < p.count; ++i) {
    const Index a = face_nodes[4 * faces[2 * i]], b = face_nodes[4 * faces[2 * i + 1]];
    some[i] = (comes[a] || comes[b]) && !out[a] && !out[b];
  }
  return some;
}

}  // namespace

void bond_again(Model& m, State& s, const Flag* comes, const Flag* bonded) {
  constexpr Real near = 0.1;  // parts of the pair's length
  for_each_pair_set(m, s, [&](auto kind, const PairSet& p, PairState& ps) {
    std::vector<Flag> some = pairs_to_bond(m, s, p, comes);
    const PairLengths lengths = on_host(pair_lengths(m, p));
    visit_points(kind, m, s, p, ps, [&](const Point& point) {
      if (norm(point.jump) > near * lengths.at(point.pair)) some[point.pair] = 0;
    });
    const BeginHistory begin_history(m, p, ps);
    const auto rest = on_host(ps.rest), rise = on_host(ps.rise), bond = on_host(ps.bond);
    const auto slip1 = on_host(ps.slip1), slip2 = on_host(ps.slip2);
    visit_points(kind, m, s, p, ps, [&](const Point& point) {
      if (!some[point.pair]) return;
      const Vec3<Real> axes[] = {point.frame.n, point.frame.t1, point.frame.t2};
      for (std::size_t axis = 0; axis < 3; ++axis)
        rest[point.place + axis * point.row] = dot(point.jump, axes[axis]);
      bond[point.place] = bonded[point.interface] ? 1 : 0;
      slip1[point.place] = slip2[point.place] = 0;
      if (rise.size() > 0) rise[point.place] = 0;
      begin_history(point.pair, point.place);
    });
    const auto status = on_host(ps.status);
    const auto jump = on_host(ps.jump), jump_at_break = on_host(ps.jump_at_break);
    for (Index i = 0; i < p.count; ++i) {
      if (!some[i]) continue;
      status[i] = Flag(PairStatus::bonded);
      jump[i] = 0;
      jump_at_break[i] = -1;
    }
  });
}

}  // namespace cdem
