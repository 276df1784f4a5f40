// change_damping.cpp - see change_damping.hpp.
#include "core/elements/change_damping.hpp"

#include <vector>

#include "core/elements/report.hpp"
#include "core/elements/views.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Energy of the branches of each element  [J].
template <class Shape>
std::vector<Real> branch_energy(const Model& m, const State& s, const ElementSet& e,
                                ElementState& es) {
  const ElementColumns<Shape> columns = on_host(element_columns<Shape>(m, s, e));
  const RockDamping<Shape> damping = on_host(rock_damping<Shape>(m, s, e, es, false));
  std::vector<Real> energy(e.count);
  for (Index i = 0; i < e.count && damping.branch.data; ++i)
    energy[i] = damping.stored(columns, One{i});
  return energy;
}

/// Room for what the damping of elements remembers: as it was, or nothing yet.
template <class Shape>
void make_room(const Model& m, const ElementSet& e, ElementState& es) {
  es.branch.resize(m.maxwell.any() ? std::size_t(RockDamping<Shape>::branch_rows) * e.stride : 0);
  es.dashpot.resize(m.damping_time > 0 ? std::size_t(RockDamping<Shape>::dashpot_rows) * e.stride
                                       : 0);
}

void make_room(const Model& m, const PairSet& p, PairState& ps) {
  const bool any = m.damping_time > 0;
  ps.dashpot.resize(any ? 3 * std::size_t(p.points) * p.point_stride : 0);
  if (any) ps.damping_work.resize(p.stride);
}

template <class Shape>
void scale_strains(const Model& m, State& s, const ElementSet& e, ElementState& es, Real part) {
  const ElementColumns<Shape> columns = on_host(element_columns<Shape>(m, s, e));
  const PointFlow<Shape> flow = on_host(point_flow<Shape>(s, e, es));
  for (Index i = 0; i < e.count; ++i) {
    const One one{i};
    const PointStrains<Shape, FollowRotation, Real> p(columns, one, flow.may_flow());
    const ElasticStrains<Shape, Real> elastic = flow.elastic_part(columns, one, p);
    for (Index q = 0; q < Shape::points; ++q)
      flow.add_inelastic(one, q, (1 - 1 / part) * elastic.part[q]);
  }
  for (Real& strain : on_host(es.branch)) strain /= part;
}

std::vector<std::vector<Real>> energies_of(const Model& m, State& s) {
  std::vector<std::vector<Real>> all;
  for_each_element_set(m, s, [&](auto, const ElementSet&, const ElementState& es) {
    all.push_back(fetch(es.energy));
  });
  return all;
}

}  // namespace

void change_damping(Model& m, State& s, const MaxwellBranches& maxwell, Real damping_time) {
  std::vector<std::vector<Real>> before;
  for_each_element_set(m, s, [&]<class Shape>(ElementKind<Shape>, ElementSet& e, ElementState& es) {
    before.push_back(branch_energy<Shape>(m, s, e, es));
  });
  m.maxwell = maxwell;
  m.damping_time = damping_time;
  auto was = before.begin();
  for_each_element_set(m, s, [&]<class Shape>(ElementKind<Shape>, ElementSet& e, ElementState& es) {
    make_room<Shape>(m, e, es);
    const std::vector<Real> now = branch_energy<Shape>(m, s, e, es);
    const auto energy = on_host(es.energy);
    for (Index i = 0; i < e.count; ++i) {
      energy[i] += now[i] - (*was)[i];
      s.stopped_energy += (*was)[i] - now[i];
    }
    ++was;
  });
  for_each_pair_set(m, s, [&](auto, PairSet& p, PairState& ps) { make_room(m, p, ps); });
}

void change_moduli(Model& m, State& s, Real part) {
  const Real factor = part / moduli_part(s);
  const auto sampled = energies_of(m, s);
  report_elements(m, s, {});
  const auto before = energies_of(m, s);
  for_each_element_set(m, s, [&]<class Shape>(ElementKind<Shape>, ElementSet& e, ElementState& es) {
    scale_strains<Shape>(m, s, e, es, factor);
  });
  for (Column<Real>* column : {&s.nodal.start, &s.nodal.after})
    for (Real& strain : on_host(*column)) strain /= factor;
  for (Column<Real>* column : {&m.material_lambda, &m.material_mu})
    for (Real& modulus : on_host(*column)) modulus *= factor;
  s.moduli.assign(std::vector<Real>(part == 1 ? 0 : 1, part));
  report_elements(m, s, {});
  std::size_t set = 0;
  for_each_element_set(m, s, [&](auto, const ElementSet& e, ElementState& es) {
    const auto energy = on_host(es.energy);
    for (Index i = 0; i < e.count; ++i) {
      const Real more = energy[i] - before[set][i];
      energy[i] = sampled[set][i] + more;
      s.energy_start += more;
    }
    ++set;
  });
}

}  // namespace cdem
