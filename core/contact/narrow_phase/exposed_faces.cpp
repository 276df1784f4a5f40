// exposed_faces.cpp - see exposed_faces.hpp.
#include "core/contact/narrow_phase/exposed_faces.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/edge_contacts.hpp"
#include "core/interfaces/history.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

/// Visit all state that belongs to exposed faces: column, numbers a face, initial value of a new
/// one with.
template <class Visit>
void visit_faces(State& s, Visit&& visit) {
  SpringState& c = s.springs;
  visit(c.target, 4, Index(-1));
  visit(c.target_before, 4, Index(-1));
  for (Column<Real>* column : {&c.friction, &c.dashpot, &c.rim_action}) visit(*column, 4, Real(0));
  for (Column<Real>* column : {&c.state, &c.reaction}) visit(*column, 4 * 8, Real(0));
  if (c.rolling.size() > 0) visit(c.rolling, 4 * 8, Real(0));
  visit(c.lost, 4, Flag(0));
  visit(s.edges.friction, 1, Real(0));
  visit(s.edges.dashpot, 1, Real(0));
  visit(s.edges.lost, 1, Flag(0));
  for (HistoryColumns* history : {&c.history, &s.edges.side_history})
    if (history->width > 0) {
      visit(history->rows, 4 * history->width, Real(0));
      visit(history->law, 4, Index(-1));
    }
  visit(s.face_geometry, 8, Real(0));
  visit(s.contact_force, 4 * 4, Real(0));
}

/// `listed` limits the search for sharp sides to some faces; null stands for all.
void launch_geometry(const Model& m, State& s, Queue q, const Flag* listed) {
  const Index count = Index(s.search.exposed_face.size());
  const Index* exposed = s.search.exposed_face.data();
  for_each_item(q, count,
                UpdateFaceGeometry{.faces = face_columns(m, s),
                                   .exposed_face = exposed,
                                   .table = s.search.exposed.data(),
                                   .rows = s.face_geometry.data()});
  for_each_item(q, count,
                MarkSharpSides{.faces = face_columns(m, s),
                               .listed = listed,
                               .table = s.search.exposed.data(),
                               .rows = s.face_geometry.data()});
}

}  // namespace

void expose(State& s, Index face) {
  Index& place = on_host(s.search.face_exposed)[face];
  if (place >= 0) return;
  place = Index(s.search.exposed_face.size());
  const std::size_t count = s.search.exposed_face.size() + 1;
  s.search.exposed_face.resize(count, face);
  visit_faces(s, [&](auto& column, Index row, auto fill) { column.resize(row * count, fill); });
  s.edges.first.resize(count + 1, Index(s.edges.contact.size() / 4));
}

namespace {

/// Keep these exposed faces, in this order: place x was from[x].
void keep_exposed(State& s, const std::vector<Index>& from) {
  const auto exposed = on_host(s.search.exposed_face), place = on_host(s.search.face_exposed);
  const std::size_t count = from.size();
  std::vector<Index> to(exposed.size(), -1);  // places
  for (std::size_t x = 0; x < count; ++x) to[from[x]] = Index(x);
  for (std::size_t x = 0; x < to.size(); ++x) place[exposed[x]] = to[x];
  const auto follow = [&](Column<Index>& targets) {
    for (Index& target : on_host(targets))
      if (target >= 0) target = to[target];
  };
  follow(s.springs.target);
  follow(s.springs.target_before);
  sort_edges(s, from, to);
  const auto sort_rows = [&](auto& column, std::size_t row, auto) {
    const auto before = fetch(column);
    const auto items = on_host(column);
    for (std::size_t x = 0; x < count; ++x)
      std::copy_n(before.begin() + row * from[x], row, items.begin() + row * x);
    column.resize(row * count);
  };
  visit_faces(s, sort_rows);
  sort_rows(s.search.exposed_face, 1, Index(-1));
}

}  // namespace

void sort_exposed(State& s) {
  const auto exposed = on_host(s.search.exposed_face);
  if (std::is_sorted(exposed.begin(), exposed.end())) return;
  std::vector<Index> from(exposed.size());
  std::iota(from.begin(), from.end(), 0);
  std::sort(from.begin(), from.end(), [&](Index a, Index b) { return exposed[a] < exposed[b]; });
  keep_exposed(s, from);
}

void hide(State& s, const std::vector<Flag>& hidden) {
  const auto exposed = on_host(s.search.exposed_face), targets = on_host(s.springs.target);
  const auto targets_before = on_host(s.springs.target_before);
  const auto state = on_host(s.springs.state), reaction = on_host(s.springs.reaction);
  const auto rolling = on_host(s.springs.rolling);
  const Index count = Index(exposed.size());
  const auto leaves = [&](Index x) { return hidden[exposed[x]] != 0; };
  std::vector<Index> from;
  for (Index x = 0; x < count; ++x)
    if (!leaves(x)) from.push_back(x);
  for (Index slot = 0; slot < 4 * count; ++slot) {
    const Index target = targets[slot];
    if (target < 0 || !leaves(target)) continue;
    targets[slot] = targets_before[slot] = -1;
    for (const OnHost<Real>& rows : {state, reaction, rolling})
      for (std::size_t k = 8 * std::size_t(slot); k < 8 * std::size_t(slot) + 8; ++k)
        if (k < rows.size()) rows[k] = 0;
  }
  keep_exposed(s, from);
}

void list_exposed(const Model& m, State& s) {
  s.search.exposed.resize(s.search.exposed_face.size());
  const auto exposed_face = on_host(s.search.exposed_face), across = on_host(s.search.across);
  const auto place = on_host(s.search.face_exposed);
  const auto rows = on_host(s.search.exposed);
  const auto face_nodes = on_host(m.face_nodes), classes = on_host(m.face_interface_class);
  const auto reach = on_host(m.face_reach), area = on_host(m.face_area);
  const auto stiffness = on_host(m.face_stiffness);
  for (std::size_t x = 0; x < rows.size(); ++x) {
    const Index face = exposed_face[x];
    ExposedRow& row = rows[x];
    const Index* nodes = face_nodes.data() + 4 * std::size_t(face);
    for (Index k = 0; k < 4; ++k) {
      const Index beyond = across[4 * x + k];
      row.corner[k] = nodes[k] < 0 ? nodes[2] : nodes[k];
      row.beside[k] = beyond < 0 ? -1 : place[beyond];
    }
    row.reach = reach[face];
    row.area = area[face] / row.count();
    row.stiffness = stiffness[face];
    row.interface_class = classes[face];
  }
}

void update_face_geometry(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::contact);
  if (has_contact_pairs(s)) launch_geometry(m, s, q, s.search.outer.face_listed.data());
}

void update_all_face_geometry(const Model& m, State& s, Queue q) {
  launch_geometry(m, s, q, nullptr);
}

}  // namespace cdem
