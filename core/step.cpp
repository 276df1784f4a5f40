// step.cpp - the method on one page. Each call is one file and one section of the theory manual.
#include "core/step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/backend.hpp"
#include "core/check.hpp"
#include "core/close_lists.hpp"
#include "core/columns.hpp"
#include "core/contact/force.hpp"
#include "core/edge_list.hpp"
#include "core/elements/corotational.hpp"
#include "core/elements/incremental.hpp"
#include "core/hand_over.hpp"
#include "core/nodes/free_block.hpp"
#include "core/rest.hpp"

namespace cdem {

namespace {

/// Factors of all curves at one time; piecewise linear, constant outside.
void evaluate_at(const Model& m, Real time, Column<Real>& values) {
  values.resize(m.curve_time.size());
  for (std::size_t c = 0; c < m.curve_time.size(); ++c) {
    const auto& t = m.curve_time[c];
    const auto& f = m.curve_factor[c];
    const std::size_t after = std::upper_bound(t.begin(), t.end(), time) - t.begin();
    if (after == 0) {
      values[c] = f.front();
    } else if (after == t.size()) {
      values[c] = f.back();
    } else {
      const Real part = (time - t[after - 1]) / (t[after] - t[after - 1]);
      values[c] = f[after - 1] + part * (f[after] - f[after - 1]);
    }
  }
}

template <Index count>
void update_conforming(const Model& m, State& s, Queue q, const PairSet& p, PairState& ps,
                       Real indentation, bool sampled) {
  launch(q, p.count, awake(s, ps.awake),
         ConformingBonds<count>{{s.nodes.motion.data()},
                                {p.nodes.data(), p.stride},
                                pair_columns(m, p, ps),
                                indentation,
                                s.dt_last,
                                sampled,
                                {s.corner_force.data() + std::size_t(p.corner_first) * 4}});
}

void update_bonds(const Model& m, State& s, Queue q, bool sampled) {  // contact/bond.hpp
  update_conforming<3>(m, s, q, m.triangles, s.triangles, m.bond_indentation_triangle, sampled);
  update_conforming<4>(m, s, q, m.quads, s.quads, m.bond_indentation_quad, sampled);
  const PairSet& p = m.overlaps;
  launch_one(q, p.count, awake(s, s.overlaps.awake),
             OverlapBonds{face_columns(m, s),
                          p.faces.data(),
                          p.point_first.data(),
                          p.weights_a.data(),
                          p.weights_b.data(),
                          p.point_area.data(),
                          pair_columns(m, p, s.overlaps),
                          {s.corner_force.data() + std::size_t(p.corner_first) * 4}});
}

void find_target_faces(const Model& m, State& s, Queue q) {  // Eq. 6-9, contact/target_face.hpp
  const Index count = Index(s.search.exposed_face.size());
  const FaceSearch search = face_search(m, s);
  launch_picked(q, count, KeepTargetFaces{search});
  launch_picked(q, count, SiftTargetFaces{search});
  launch_one(q, 4 * count, FindTargetFaces{search});
}

void find_target_edges(const Model& m, State& s, Queue q) {  // Eq. 10-12, contact/target_edge.hpp
  if (!m.semi_edges) return;
  begin_edges(s);
  const Index pairs = Index(s.search.close.near_edges.size());
  launch(q, pairs,
         SiftTargetEdges{{s.nodes.motion.data()},
                         face_geometry(s),
                         edge_pairs(s),
                         m.rules,
                         s.edges.old_first.data()});
  do {
    launch_picked(q, pairs, edge_search(m, s));
    finish(q);
  } while (!make_room_for_edges(s));
  launch_one(q, Index(s.search.exposed_face.size()),
             ListEdges{edge_search(m, s), s.edges.first.data(), s.edges.contact.data(),
                       s.edges.friction.data(), s.edges.dashpot.data()});
}

void hand_over_released(const Model& m, State& s, Queue q) {  // hand_over.hpp
  if (s.released_overlaps.size() == 0) return;
  finish(q);
  hand_over_overlaps(m, s);
}

void update_contact_forces(const Model& m, State& s, Queue q) {  // Eq. 13-14, contact/force.hpp
  const Index count = Index(s.search.exposed_face.size());
  const Index* exposed = s.search.exposed_face.data();
  const FaceGeometry geometry = face_geometry(s);
  launch_picked(q, count,
                UpdateSpringForces{face_columns(m, s), geometry, m.rules, contact_laws(m, s),
                                   spring_columns(s)});
  launch(q, Index(s.edges.contact.size() / 4),
         UpdateEdgeForces{face_columns(m, s), geometry, exposed, contact_laws(m, s),
                          s.edges.old_state.data(), edge_columns(s)});
}

void make_rows(ActingState& acting) {
  const std::size_t count = acting.count.size();
  acting.first.resize(count + 1);
  for (std::size_t i = 0; i < count; ++i) acting.first[i + 1] = acting.first[i] + acting.count[i];
  acting.contact.resize(acting.first[count]);
}

void gather_contact_forces(const Model& m, State& s, Queue q) {  // contact/gather.hpp
  const Index count = Index(s.search.exposed_face.size());
  const ContactsOf contacts{spring_columns(s), edge_columns(s), count};
  ActingState& acting = s.acting;
  acting.count.resize(count);
  acting.count.fill(0);
  acting.place.resize(s.springs.target.size() + s.edges.contact.size() / 4);
  launch_one(q, count,
             CountActing{contacts, acting.count.data(), acting.place.data(), runs_alone()});
  finish(q);
  make_rows(acting);
  const Acting rows{acting.first.data(), acting.contact.data()};
  launch_one(q, count, ListActing{contacts, acting.place.data(), rows});
  launch_one(q, count,
             GatherFaceForces{contacts, face_columns(m, s), s.search.exposed_face.data(),
                              s.search.face_listed.data(), rows, m.rules, s.edges.friction.data(),
                              s.edges.dashpot.data(), s.contact_force.data()});
}

NodeDamping node_damping(const Model& m, const State& s) {
  return {m.damping.local, m.damping.mass + s.relax_damping};
}
bool damps_nodes(const Model& m, const State& s) {
  const NodeDamping damping = node_damping(m, s);
  return damping.local > 0 || damping.mass > 0;
}

/// Do free blocks go apart in this step? Not where something looks at forces, or damps them.
bool free_go_apart(const Model& m, const State& s, bool sampled) {
  return s.nodes.free.size() > 0 && !sampled && !s.all_awake && !s.stop_due && !damps_nodes(m, s);
}

template <class Shape>
void update_elements(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es,
                     bool free_too) {
  const ElementColumns<Shape> columns = element_columns<Shape>(m, s, e);
  const OutForces out{s.corner_force.data() + std::size_t(e.corner_first) * 4};
  const InOutTable work{es.damping_work.data(), e.stride}, energy{es.energy.data(), e.stride};
  const InOutTable stress{es.point_stress.data(), e.stride};
  const Real damping_time = m.stiffness_damping * s.dt;
  const Blocks some = awake(s, free_too ? es.awake : es.free.others);
  switch (m.formulation) {
    case Formulation::corotational:
      return launch(
          q, e.count, some,
          CorotationalForce<Shape, FollowRotation>{columns, damping_time, s.dt, work, out});
    case Formulation::paper_total:
      return launch(
          q, e.count, some,
          CorotationalForce<Shape, IgnoreRotation>{columns, damping_time, s.dt, work, out});
    case Formulation::incremental:
      return launch(q, e.count, some,
                    IncrementalForce<Shape, TurnByHalves>{columns, s.dt_last, stress, energy, out});
    case Formulation::paper_incremental:
      return launch(q, e.count, some,
                    IncrementalForce<Shape, NeverTurn>{columns, s.dt_last, stress, energy, out});
  }
}

void update_element_forces(const Model& m, State& s, Queue q, bool free_too) {  // Eq. 2, elements/
  update_elements<Tet4>(m, s, q, m.tet4, s.tet4, free_too);
  update_elements<Pyramid5>(m, s, q, m.pyramid5, s.pyramid5, true);
  update_elements<Wedge6>(m, s, q, m.wedge6, s.wedge6, true);
  if (m.hex8.hourglass.size() > 0)
    update_elements<Hex8OnePoint>(m, s, q, m.hex8, s.hex8, free_too);
  else
    update_elements<Hex8>(m, s, q, m.hex8, s.hex8, free_too);
}

template <class Shape>
void advance_free(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es) {
  const FreeBlocks& free = es.free;
  const CorotationalForce<Shape, FollowRotation> element{element_columns<Shape>(m, s, e),
                                                         m.stiffness_damping * s.dt,
                                                         s.dt,
                                                         {es.damping_work.data(), e.stride},
                                                         {}};
  launch(q, e.count, awake(s, free.blocks),
         AdvanceFree<Shape>{element,
                            {free.row_first.data(), free.row.data()},
                            {s.corner_force.data()},
                            load_columns(m, s),
                            mass_columns(m, s),
                            s.dt_last,
                            s.dt,
                            s.nodes.motion.data(),
                            s.nodes.work_external.data()});
}

void advance_free_blocks(const Model& m, State& s, Queue q) {  // nodes/free_block.hpp
  advance_free<Tet4>(m, s, q, m.tet4, s.tet4);
  if (m.hex8.hourglass.size() > 0)
    advance_free<Hex8OnePoint>(m, s, q, m.hex8, s.hex8);
  else
    advance_free<Hex8>(m, s, q, m.hex8, s.hex8);
}

SumNodeForces node_forces(const Model& m, State& s, bool sampled) {
  const NodeDamping damping = node_damping(m, s);
  const bool damps = damps_nodes(m, s);
  if (damps) s.nodes.damping_force.resize(s.nodes.force.size());
  s.nodes.damped = damps;
  return {{s.nodes.motion.data()},
          corner_lists(s),
          load_columns(m, s),
          support_columns(m, s),
          damping,
          mass_columns(m, s),
          0.5 * (s.dt_last + s.dt),
          s.nodes.force.data(),
          damps ? s.nodes.damping_force.data() : nullptr,
          sampled ? s.nodes.unbalance.data() : nullptr};
}

MoveNodes node_motion(const Model& m, State& s) {
  return {mass_columns(m, s),
          load_columns(m, s),
          support_columns(m, s),
          s.nodes.force.data(),
          damping_forces(s),
          s.dt_last,
          s.dt,
          s.nodes.motion.data(),
          s.nodes.reaction.data(),
          s.nodes.work_external.data(),
          s.nodes.work_damping.data()};
}

void sum_node_forces(const Model& m, State& s, Queue q) {  // nodes/motion.hpp
  launch_one(q, m.node_count, awake(s, s.nodes.awake), node_forces(m, s, true));
}

void move_nodes(const Model& m, State& s, Queue q) {  // nodes/motion.hpp
  launch_one(q, m.node_count, awake(s, s.nodes.awake), node_motion(m, s));
  finish(q);
}

void advance_nodes(const Model& m, State& s, Queue q, bool free_too) {  // nodes/motion.hpp
  const SumNodeForces sum = node_forces(m, s, s.all_awake);
  launch_one(q, m.node_count, awake(s, free_too ? s.nodes.awake : s.nodes.others),
             AdvanceNodes{sum, node_motion(m, s), free_too ? nullptr : s.nodes.free.data()});
  finish(q);
}

/// Counts wall time by phase of the step.
struct Stopwatch {
  State& s;
  std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();

  void lap(Phase phase) {
    const auto now = std::chrono::steady_clock::now();
    s.seconds[int(phase)] += std::chrono::duration<Real>(now - last).count();
    last = now;
  }
};

/// One step: contacts, elements, nodes. Everything before move_nodes belongs to the time `s.time`.
void step(const Model& m, State& s, Queue q, bool sampled) {
  Stopwatch watch{s};
  if (refresh_is_due(m, s)) {
    refresh_contacts(m, s);
    renew_step(m, s);  // faces that may now touch call for a shorter step before they do
  }
  watch.lap(Phase::refresh);
  evaluate_curves(m, s);
  update_face_geometry(m, s, q, false);  // contact/face.hpp
  update_bonds(m, s, q, sampled || s.all_awake);
  watch.lap(Phase::contact);
  const bool contacts = may_have_contacts(s);
  if (contacts && close_lists_are_old(s)) list_close(m, s, q);  // contact/close.hpp
  if (contacts) find_target_faces(m, s, q);
  if (contacts) find_target_edges(m, s, q);
  if (contacts) hand_over_released(m, s, q);
  if (m.check_search) s.missed += count_missed_contacts(m, s);
  watch.lap(Phase::search);
  if (contacts) update_contact_forces(m, s, q);
  if (contacts) gather_contact_forces(m, s, q);
  watch.lap(Phase::contact);
  const bool apart = free_go_apart(m, s, sampled);
  update_element_forces(m, s, q, !apart);
  if (apart) advance_free_blocks(m, s, q);
  watch.lap(Phase::element);
  if (sampled || s.stop_due) {
    sum_node_forces(m, s, q);
    if (s.stop_due) stop_motion(m, s);
    if (sampled) sample_before(m, s, q);
    move_nodes(m, s, q);
    if (sampled) sample_after(m, s, q);
  } else {
    advance_nodes(m, s, q, !apart);
  }
  if (s.all_awake) find_awake(m, s);
  s.all_awake = false;
  s.dt_last = s.dt;
  s.time += s.dt;
  s.step += 1;
  grow_step(s);
  // more contacts may press on a node than the lists foresaw
  if (contacts || s.step % step_check_interval == 0) renew_step(m, s);
  watch.lap(Phase::node);
}

/// Kinetic relaxation: stop all motion when the kinetic energy has passed a peak.
void relax_kinetically(const Model& m, State& s) {
  const Real kinetic = kinetic_energy(m, s);
  s.stop_due = kinetic < s.kinetic_peak;
  s.kinetic_peak = s.stop_due ? 0 : kinetic;
}

/// Adaptive relaxation: damp critically the mode that moves now. Its frequency is the Rayleigh
/// quotient of the last displacement, v . K v / v . M v, with K v from the change of the forces.
void relax_adaptively(const Model& m, State& s) {
  const std::size_t rows = 8 * std::size_t(m.node_count);
  const bool known = s.nodes.relax.size() == rows;
  s.nodes.relax.resize(rows);
  Real* before = s.nodes.relax.data();
  const Real *force = s.nodes.force.data(), *damping = damping_forces(s),
             *motion = s.nodes.motion.data();
  const auto undamped = [&](std::size_t i, std::size_t k) {
    return damping ? force[4 * i + k] - damping[4 * i + k] : force[4 * i + k];
  };
  if (known) {
    const Real stiff = ordered_sum(m.node_count, [&](std::size_t i) {
      Real sum = 0;
      for (std::size_t k = 0; k < 3; ++k)
        sum -= before[8 * i + 4 + k] * (undamped(i, k) - before[8 * i + k]);
      return sum;
    });
    const Column<Real>& mass = lumped_masses(m, s);
    const Real heavy = ordered_sum(m.node_count, [&](std::size_t i) {
      const Real* v = before + 8 * i + 4;
      return mass[i] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    });
    // the damping force lags by half a step, so w dt < sqrt(4 - 2 c dt) must hold for the fastest
    // mode
    const Real most = 1.8 * (1 - relax_safety * relax_safety) / s.dt_last;
    const Real critical = heavy > 0 && stiff > 0 ? 2 * std::sqrt(stiff / (s.dt_last * heavy)) : 0;
    s.relax_damping = std::min(critical, most);
  }
#pragma omp parallel for schedule(static) if (m.node_count >= worth_threads)
  for (std::size_t i = 0; i < std::size_t(m.node_count); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      before[8 * i + k] = undamped(i, k);
      before[8 * i + 4 + k] = motion[8 * i + 4 + k];
    }
}

}  // namespace

void evaluate_curves(const Model& m, State& s) {
  evaluate_at(m, s.time, s.load_factor);
  evaluate_at(m, s.time + 0.5 * s.dt, s.velocity_factor);
}

Report run(const Model& m, State& s, const Goal& goal) {
  if (goal.relaxation != Relaxation::adaptive) s.relax_damping = 0;
  if (goal.relaxation != Relaxation::kinetic) s.stop_due = false;
  if (goal.relaxation == Relaxation::adaptive && s.nodes.relax_mass.size() == 0) scale_masses(m, s);
  s.all_awake = true;  // loads, supports or strengths may have been changed
  for (std::int64_t n = 1; n <= goal.steps; ++n) {
    const bool last = n == goal.steps || s.time + s.dt >= goal.end_time;
    const bool scheduled = s.step % goal.check_interval == 0;  // whatever the split into runs
    const bool check = last || scheduled;
    // what a step samples changes no motion: where nothing asks for it, it need not be the same
    const bool sampled = last || !s.ledger_started || goal.relaxation == Relaxation::kinetic ||
                         (scheduled && goal.unbalance_limit > 0);
    step(m, s, {}, sampled);
    if (goal.relaxation == Relaxation::kinetic) relax_kinetically(m, s);
    if (goal.relaxation == Relaxation::adaptive) relax_adaptively(m, s);
    if (s.missed > 0) return {Outcome::missed_contact, -1, Real(s.missed)};
    if (!check) continue;
    const Report report = check_health(m, s);
    if (report.outcome != Outcome::steps_done) return report;
    if (s.time >= goal.end_time) return {Outcome::time_reached, -1, s.time};
    if (scheduled && goal.unbalance_limit > 0 && unbalance_ratio(m, s) < goal.unbalance_limit)
      return {Outcome::converged, -1, s.time};
  }
  return {};
}

}  // namespace cdem
