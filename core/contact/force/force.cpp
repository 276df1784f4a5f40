// force.cpp - see force.hpp.
#include "core/contact/force/force.hpp"

#include <type_traits>

#include "core/base/primitives.hpp"
#include "core/contact/force/accumulate.hpp"
#include "core/contact/force/change_of_target.hpp"
#include "core/contact/force/contact_area.hpp"
#include "core/contact/force/edge_force.hpp"
#include "core/contact/force/rolling.hpp"
#include "core/contact/force/spring_force.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

/// Call launch(kernel) with the kernel for the laws that a model has. One that unloads otherwise
/// than it loads has a kernel for all laws only: few models have it.
template <template <class> class Unloading, class Kernel, class Launch>
void with_laws_of(const InterfaceTable& table, const Kernel& kernel, const Launch& launch) {
  if constexpr (std::is_same_v<Unloading<Real>, HystereticUnloading<Real>>)
    launch(WithLaws<Kernel, InterfaceLaws>{kernel});
  else
    with_laws(table, kernel, launch);
}

template <template <class> class Unloading>
void update_spring_forces(const Model& m, State& s, Queue q) {
  const Index count = Index(s.search.exposed_face.size());
  const FaceColumns faces = face_columns(m, s);
  const FaceGeometry geometry = face_geometry(s);
  const ContactLaws laws = contact_laws(m, s);
  const SpringColumns springs = spring_columns(s);
  for_each_item(q, count,
                ChangeTargets{.faces = faces,
                              .geometry = geometry,
                              .rules = m.rules,
                              .laws = laws,
                              .springs = springs});
  with_laws_of<Unloading>(laws.interfaces,
                          UpdateSpringForces<Unloading>{.faces = faces,
                                                        .geometry = geometry,
                                                        .rules = m.rules,
                                                        .laws = laws,
                                                        .springs = springs,
                                                        .history = history_rows(s.springs.history)},
                          [&](const auto& kernel) { for_each_selected(q, count, kernel); });
}

template <template <class> class Unloading>
void update_edge_forces(const Model& m, State& s, Queue q) {
  const Index contacts = Index(s.edges.contact.size() / 4);
  const Index width = s.edges.side_history.width;
  s.edges.contact_history.rows.renew(width * std::size_t(contacts));
  s.edges.contact_history.law.renew(width > 0 ? contacts : 0);
  const HistoryRows sides = history_rows(s.edges.side_history),
                    own = history_rows(s.edges.contact_history);
  with_laws_of<Unloading>(interface_table(m),
                          UpdateEdgeForces<Unloading>{.faces = face_columns(m, s),
                                                      .geometry = face_geometry(s),
                                                      .laws = contact_laws(m, s),
                                                      .state_before = s.edges.old_state.data(),
                                                      .edges = edge_columns(s),
                                                      .side_history = sides,
                                                      .contact_history = own},
                          [&](const auto& kernel) { for_each_lane(q, contacts, kernel); });
  if (width > 0)
    for_each_item(q, Index(s.search.exposed_face.size()),
                  MergeSideHistories{edge_columns(s), sides, own});
}

ContactsOf contacts_of(State& s) {
  return {spring_columns(s), edge_columns(s), Index(s.search.exposed_face.size())};
}

void list_contacts_by_target(State& s, Queue q) {
  const Index count = Index(s.search.exposed_face.size());
  ContactsByTargetState& acting = s.contacts_by_target;
  list_rows_in_room(q, count, 4 * count + Index(s.edges.contact.size() / 4), count, contacts_of(s),
                    acting.first, acting.contact);
}

ContactsByTarget contacts_by_target(const State& s) {
  return {s.contacts_by_target.first.data(), s.contacts_by_target.contact.data()};
}

void share_areas(const Model& m, State& s, Queue q) {
  const Index count = Index(s.search.exposed_face.size());
  ContactAreasState& areas = s.contact_areas;
  areas.touching.renew(4 * std::size_t(count));
  areas.per_stiffness.renew(count);
  for_each_item(q, count,
                SumTouching{.contacts = contacts_of(s),
                            .acting = contacts_by_target(s),
                            .geometry = face_geometry(s),
                            .laws = contact_laws(m, s),
                            .edge_state_before = s.edges.old_state.data(),
                            .rows = areas.touching.data()});
  for_each_item(q, count,
                ShareAreas{.faces = face_columns(m, s),
                           .geometry = face_geometry(s),
                           .laws = contact_laws(m, s),
                           .rules = m.rules,
                           .exposed_face = s.search.exposed_face.data(),
                           .facing_first = s.search.outer.acting_first.data(),
                           .facing = s.search.outer.faces_acting_on.data(),
                           .touching = areas.touching.data(),
                           .area_per_stiffness = areas.per_stiffness.data()});
}

void accumulate_forces(const Model& m, State& s, Queue q) {
  const Index count = Index(s.search.exposed_face.size());
  for_each_item(q, count,
                AccumulateFaceForces{
                    contacts_of(s), face_columns(m, s), s.search.exposed_face.data(),
                    s.search.outer.face_listed.data(), contacts_by_target(s), m.rules,
                    s.edges.friction.data(), s.edges.dashpot.data(), s.contact_force.data()});
}

void add_rolling_couples(const Model& m, State& s, Queue q) {
  const Index count = Index(s.search.exposed_face.size());
  s.springs.rolling.resize(4 * 8 * std::size_t(count), Real(0));
  for_each_item(q, count,
                UpdateRollingCouples{.faces = face_columns(m, s),
                                     .geometry = face_geometry(s),
                                     .laws = contact_laws(m, s),
                                     .springs = spring_columns(s),
                                     .exposed_face = s.search.exposed_face.data(),
                                     .face_radius = m.face_radius.data(),
                                     .rows = s.springs.rolling.data()});
  for_each_item(q, count,
                AddRollingCouples{.contacts = contacts_of(s),
                                  .faces = face_columns(m, s),
                                  .geometry = face_geometry(s),
                                  .listed = s.search.outer.face_listed.data(),
                                  .acting = contacts_by_target(s),
                                  .rows = s.springs.rolling.data(),
                                  .corner_force = s.contact_force.data()});
}

}  // namespace

void fit_contacts_by_target(State& s) {
  ContactsByTargetState& acting = s.contacts_by_target;
  if (acting.first.size() == 0) return;
  const Transfer transfer;
  acting.contact.renew(on_host(acting.first)[acting.first.size() - 1]);
}

void update_contact_forces(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::contact);
  list_contacts_by_target(s, q);
  if (m.interface_traits.ask_area) share_areas(m, s, q);
  if (m.interface_traits.hysteretic) {
    update_spring_forces<HystereticUnloading>(m, s, q);
    update_edge_forces<HystereticUnloading>(m, s, q);
  } else {
    update_spring_forces<ElasticUnloading>(m, s, q);
    update_edge_forces<ElasticUnloading>(m, s, q);
  }
  accumulate_forces(m, s, q);
  if (m.interface_traits.rolls || s.springs.rolling.size() > 0) add_rolling_couples(m, s, q);
}

}  // namespace cdem
