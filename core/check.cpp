// check.cpp - energy ledger, unbalance ratio, stable step, and what stops a run that went wrong.
#include "core/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/backend.hpp"
#include "core/columns.hpp"
#include "core/elements/corotational.hpp"

namespace cdem {

namespace {

Real column_sum(const Column<Real>& c) {
  return ordered_sum(Index(c.size()), [&](Index i) { return c[i]; });
}

template <class Shape, class Rotation>
void report_set(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es) {
  launch(q, e.count,
         CorotationalReport<Shape, Rotation>{element_columns<Shape>(m, s, e),
                                             {es.stress.data(), e.stride},
                                             {es.energy.data(), e.stride}});
}

/// Mean over the Gauss points of the stress that the incremental forms keep.
template <class Shape>
void average_points(const ElementSet& e, ElementState& es) {
  for (Index i = 0; i < e.count; ++i)
    for (Index row = 0; row < 6; ++row) {
      Real sum = 0, volume = 0;
      for (Index q = 0; q < Shape::points; ++q) {
        const Real w = e.volume[std::size_t(q) * e.stride + i];
        sum += w * es.point_stress[std::size_t(6 * q + row) * e.stride + i];
        volume += w;
      }
      es.stress[std::size_t(row) * e.stride + i] = sum / volume;
    }
}

template <class Shape>
void report_shape(const Model& m, State& s, Queue q, const ElementSet& e, ElementState& es) {
  switch (m.formulation) {
    case Formulation::corotational:
      return report_set<Shape, FollowRotation>(m, s, q, e, es);
    case Formulation::paper_total:
      return report_set<Shape, IgnoreRotation>(m, s, q, e, es);
    default:
      return average_points<Shape>(e, es);
  }
}

/// Stress and strain energy of every element where the nodes are now.
void report_elements(const Model& m, State& s, Queue q) {
  report_shape<Tet4>(m, s, q, m.tet4, s.tet4);
  report_shape<Pyramid5>(m, s, q, m.pyramid5, s.pyramid5);
  report_shape<Wedge6>(m, s, q, m.wedge6, s.wedge6);
  if (m.hex8.hourglass.size() > 0)
    report_shape<Hex8OnePoint>(m, s, q, m.hex8, s.hex8);
  else
    report_shape<Hex8>(m, s, q, m.hex8, s.hex8);
  finish(q);
}

}  // namespace

void report_stress(const Model& m, State& s) {
  ElementState* sets[] = {&s.tet4, &s.pyramid5, &s.wedge6, &s.hex8};
  // the ledger's strain energy belongs to the last sampled step, the stress to where nodes are now
  std::vector<Real> energy[4];
  for (int k = 0; k < 4; ++k)
    energy[k].assign(sets[k]->energy.data(), sets[k]->energy.data() + sets[k]->energy.size());
  report_elements(m, s, {});
  for (int k = 0; k < 4; ++k) std::copy(energy[k].begin(), energy[k].end(), sets[k]->energy.data());
}

void sample_before(const Model& m, State& s, Queue q) {
  report_elements(m, s, q);
  launch_one(q, m.node_count,
             NodeMomentum{{s.nodes.motion.data()}, mass_columns(m, s), s.nodes.sample.data()});
}

void sample_after(const Model& m, State& s, Queue q) {
  launch_one(q, m.node_count,
             SampleNodes{{s.nodes.motion.data()},
                         load_columns(m, s),
                         support_columns(m, s),
                         s.nodes.reaction.data(),
                         damping_forces(s),
                         s.dt,
                         s.nodes.sample.data()});
  finish(q);
  if (s.ledger_started) return;
  s.ledger_started = true;
  const Energies e = energies(m, s);
  // the first sample may come later than the first step: count what has been lost and done by then
  s.energy_start =
      e.kinetic + e.strain + e.contact + e.friction + e.damping + e.fracture - e.external;
}

Real kinetic_energy(const Model& m, const State& s) {
  return ordered_sum(m.node_count, [&](Index i) { return s.nodes.sample[4 * std::size_t(i)]; });
}

namespace {

/// What the round-off of positions makes where nothing happens.
struct RoundOff {
  Real shift;  // of a node  [m]
  Real force;  // sum over the nodes  [N]
  RoundOff(const Model& m, const State& s) {
    Real farthest = 0;  // coordinate
    for (Index i = 0; i < m.node_count; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        farthest = std::max(farthest, std::abs(s.nodes.motion[8 * std::size_t(i) + axis]));
    shift = std::numeric_limits<Real>::epsilon() * farthest;
    force = shift *
            ordered_sum(m.node_count, [&](Index i) { return m.mass[i] * m.lumped_frequency2[i]; });
  }
};

Real largest_term(const Energies& e) {
  Real largest = 0;
  for (const Real term :
       {e.kinetic, e.strain, e.contact, e.friction, e.damping, e.fracture, e.external, e.start})
    largest = std::max(largest, std::abs(term));
  return largest;
}

}  // namespace

void keep_energy_scale(const Model& m, State& s) {
  s.energy_scale = std::max(s.energy_scale, largest_term(energies(m, s)));
}

Energies energies(const Model& m, const State& s) {
  const auto sample = [&](int k) {
    return ordered_sum(m.node_count,
                       [&](Index i) { return s.nodes.sample[4 * std::size_t(i) + k]; });
  };
  Energies e;
  e.kinetic = sample(0);
  e.external = column_sum(s.nodes.work_external) - sample(1);
  e.damping = column_sum(s.nodes.work_damping) - sample(2) + s.stopped_energy +
              column_sum(s.springs.dashpot) + column_sum(s.edges.dashpot);
  for (const ElementState* es : {&s.tet4, &s.pyramid5, &s.wedge6, &s.hex8}) {
    e.strain += column_sum(es->energy);
    e.damping += column_sum(es->damping_work);
  }
  const Index exposed = Index(s.search.exposed_face.size());
  const auto spring = [&](Index slot) { return ContactState::at(s.springs.state.data(), slot); };
  e.contact = ordered_sum(4 * exposed, [&](Index i) { return spring(i).energy_n; }) +
              ordered_sum(4 * exposed, [&](Index i) { return spring(i).energy_s; });
  e.contact += ordered_sum(exposed, [&](Index i) {
    Real sum = 0;
    for (Index c = s.edges.first[i]; c < s.edges.first[i + 1]; ++c) {
      const ContactState edge = ContactState::at(s.edges.state.data(), c);
      sum += edge.energy_n + edge.energy_s;
    }
    return sum;
  });
  e.friction = column_sum(s.springs.friction) + column_sum(s.edges.friction);
  for (const PairState* p : {&s.triangles, &s.quads, &s.overlaps}) {
    e.contact += column_sum(p->stored);
    e.friction += column_sum(p->friction);
    e.fracture += column_sum(p->fracture);
  }
  e.start = s.energy_start;
  const Real open =
      e.kinetic + e.strain + e.contact + e.friction + e.damping + e.fracture - e.external - e.start;
  const Real scale = std::max(s.energy_scale, largest_term(e));
  const RoundOff nothing(m, s);
  e.error = scale > 100 * nothing.force * nothing.shift ? open / scale : 0;
  return e;
}

Real unbalance_ratio(const Model& m, const State& s) {
  const Real unbalanced = column_sum(s.nodes.unbalance);
  const LoadColumns loads = load_columns(m, s);
  const SupportColumns supports = support_columns(m, s);
  // what acts on supports needs no balance: a heavy fixed bed must not hide a block that slides
  Real applied = ordered_sum(m.node_count, [&](Index i) {
    const Vec3<Real> f = loads.at(i).vector();
    return (supports.given(i, 0) ? 0 : std::abs(f.x)) + (supports.given(i, 1) ? 0 : std::abs(f.y)) +
           (supports.given(i, 2) ? 0 : std::abs(f.z));
  });
  if (applied == 0)  // moved by its supports alone: compare with what they carry
    applied = ordered_sum(m.node_count, [&](Index i) {
      const Real* r = s.nodes.reaction.data() + std::size_t(i) * 4;
      return std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]);
    });
  return unbalanced > RoundOff(m, s).force ? unbalanced / applied : 0;
}

namespace {

/// Stiffness of bonds and contacts, those that may begin included, on a node  [N/m].
Real stiffness_at(const State& s, Index i) {
  return std::max(s.nodes.force[std::size_t(i) * 4 + 3], s.node_potential[i]) + s.node_bonds[i];
}

/// Node with the highest frequency; `held` counts those that are held or driven in all directions.
Real highest_frequency2(const Model& m, const State& s, bool held, StepLimit& limit) {
  Real largest = -1;
  const MassColumns mass = mass_columns(m, s);
  const SupportColumns supports = support_columns(m, s);
  for (Index i = 0; i < m.node_count; ++i) {
    Real stiffness = 0;
    const bool dense = mass.row(i) >= 0;
    const Index first = dense ? m.block_first[i] : i;
    const Index last = dense ? first + m.block_count[i] : i + 1;
    if (dense && i != first) continue;
    Real element2 = 0;
    bool free = held;
    for (Index j = first; j < last; ++j) {
      for (Index axis = 0; axis < 3; ++axis) free = free || !supports.given(j, axis);
      stiffness = std::max(stiffness, stiffness_at(s, j));
      element2 = std::max(element2, m.lumped ? m.lumped_frequency2[j] : m.frequency2[j]);
    }
    if (!free) continue;
    // Gershgorin: a spring between two points adds at most twice its stiffness to a row
    const Real contact2 = 2 * stiffness * (m.lumped ? 1 / m.mass[i] : m.inverse_mass_bound[i]);
    if (element2 + contact2 > largest) {
      largest = element2 + contact2;
      limit.node = i;
      limit.element2 = element2;
      limit.contact2 = contact2;
    }
  }
  return largest;
}

}  // namespace

StepLimit step_limit(const Model& m, const State& s) {
  StepLimit limit;
  // what is held or driven in all directions cannot become unstable; where nothing else is, its
  // step still is what curves, histories and ends of stages are followed with
  Real largest = highest_frequency2(m, s, false, limit);
  if (!(largest > 0)) largest = highest_frequency2(m, s, true, limit);
  // a dashpot of ratio xi at the highest frequency shortens the stable step by this factor
  const Real xi =
      m.stiffness_damping + m.contact_damping + 0.5 * m.damping.mass / std::sqrt(largest);
  limit.dt =
      2 / std::sqrt(largest) * (std::sqrt(1 + xi * xi) - xi) / std::sqrt(1 + m.damping.local);
  return limit;
}

void renew_step(const Model& m, State& s) {
  s.dt_stable = m.step_given > 0 ? m.step_given : m.step_safety * step_limit(m, s).dt;
  const bool relaxes = s.nodes.relax_mass.size() > 0;
  const bool at_once = m.step_given > 0 || relaxes || !(s.dt > 0);
  s.dt = at_once ? s.dt_stable : std::min(s.dt, s.dt_stable);
  if (relaxes) scale_masses(m, s);
}

void grow_step(State& s) { s.dt = std::min(step_growth * s.dt, s.dt_stable); }

Report check_health(const Model& m, const State& s) {
  Real fastest = 0;
  Index node = -1;
  for (Index i = 0; i < m.node_count; ++i) {
    const Real* r = s.nodes.motion.data() + std::size_t(i) * 8;
    const Real v2 = r[4] * r[4] + r[5] * r[5] + r[6] * r[6];
    if (!std::isfinite(v2) || !std::isfinite(r[0] + r[1] + r[2]))
      return {Outcome::not_finite, i, v2};
    if (v2 > fastest) fastest = v2, node = i;
  }
  if (m.speed_limit > 0 && std::sqrt(fastest) > m.speed_limit)
    return {Outcome::too_fast, node, std::sqrt(fastest)};
  for (std::size_t i = 0; i < s.search.exposed_face.size(); ++i) {
    bool lost = s.edges.lost[i] != 0;
    for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) lost = lost || s.springs.lost[k];
    if (lost) return {Outcome::lost_contact, Index(i), 0};
  }
  return {};
}

namespace {

/// Half of momentum times velocity, with the present masses  [J].
Real energy_of_motion(const Model& m, const State& s) {
  const MassColumns mass = mass_columns(m, s);
  const InMotion nodes{s.nodes.motion.data()};
  return ordered_sum(m.node_count, [&](Index i) {
    return 0.5 * dot(mass.momentum(nodes, i).vector(), nodes.velocity(i));
  });
}

}  // namespace

void change_mass(Model& m, State& s, bool lumped) {
  const Real before = energy_of_motion(m, s);
  m.lumped = lumped;
  s.nodes.relax_mass.resize(0);
  s.nodes.relax.resize(0);
  s.stopped_energy += before - energy_of_motion(m, s);
}

void scale_masses(const Model& m, State& s) {
  const StepLimit limit = step_limit(m, s);
  const Real part = s.dt / (relax_safety * limit.dt);
  const Real squared = (limit.element2 + limit.contact2) / (part * part);
  const Real before = energy_of_motion(m, s);
  s.nodes.relax_mass.resize(m.node_count);
  for (Index i = 0; i < m.node_count; ++i)
    s.nodes.relax_mass[i] = (m.mass[i] * m.lumped_frequency2[i] + 2 * stiffness_at(s, i)) / squared;
  s.stopped_energy += before - energy_of_motion(m, s);
}

void stop_motion(const Model& m, State& s) {
  const LoadColumns loads = load_columns(m, s);
  const Real* damping = damping_forces(s);
  s.stopped_energy += energy_of_motion(m, s);
  // the forces of this moment have worked since the middle of the last step
  s.stopped_energy += ordered_sum(m.node_count, [&](Index i) {
    Real* v = s.nodes.motion.data() + std::size_t(i) * 8 + 4;
    const Vec3<Real> way = 0.5 * s.dt_last * Vec3<Real>{v[0], v[1], v[2]};
    s.nodes.work_external[i] += dot(loads.at(i).vector(), way);
    if (damping)
      s.nodes.work_damping[i] -= dot(Row::at(damping + std::size_t(i) * 4).vector(), way);
    v[0] = v[1] = v[2] = 0;
    return dot(Row::at(s.nodes.force.data() + std::size_t(i) * 4).vector(), way);
  });
  s.dt_last = 0;
}

}  // namespace cdem
