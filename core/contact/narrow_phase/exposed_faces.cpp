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

/// Visit all state that belongs to exposed faces: column, numbers a face, what a new one begins
/// with.
template <class Visit>
void visit_faces(State& s, Visit&& visit) {
  SpringState& c = s.springs;
  visit(c.target, 4, Index(-1));
  visit(c.target_before, 4, Index(-1));
  for (Column<Real>* column : {&c.friction, &c.dashpot}) visit(*column, 4, Real(0));
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
  if (s.search.face_exposed[face] >= 0) return;
  s.search.face_exposed[face] = Index(s.search.exposed_face.size());
  s.search.exposed_face.push(face);
  const std::size_t count = s.search.exposed_face.size();
  visit_faces(s, [&](auto& column, Index row, auto fill) { column.resize(row * count, fill); });
  s.edges.first.resize(count + 1, Index(s.edges.contact.size() / 4));
}

namespace {

/// Keep these exposed faces, in this order: place x was from[x].
void keep_exposed(State& s, const std::vector<Index>& from) {
  Column<Index>&exposed = s.search.exposed_face, &place = s.search.face_exposed;
  const std::size_t count = from.size();
  std::vector<Index> to(exposed.size(), -1);  // places
  for (std::size_t x = 0; x < count; ++x) to[from[x]] = Index(x);
  for (std::size_t x = 0; x < to.size(); ++x) place[exposed[x]] = to[x];
  const auto follow = [&](Column<Index>& targets) {
    for (std::size_t k = 0; k < targets.size(); ++k)
      if (targets[k] >= 0) targets[k] = to[targets[k]];
  };
  follow(s.springs.target);
  follow(s.springs.target_before);
  sort_edges(s, from, to);
  const auto sort_rows = [&](auto& column, std::size_t row, auto) {
    const auto before = std::vector(column.data(), column.data() + row * to.size());
    for (std::size_t x = 0; x < count; ++x)
      std::copy_n(before.data() + row * from[x], row, column.data() + row * x);
    column.resize(row * count);
  };
  visit_faces(s, sort_rows);
  sort_rows(exposed, 1, Index(-1));
}

}  // namespace

void sort_exposed(State& s) {
  const Column<Index>& exposed = s.search.exposed_face;
  if (std::is_sorted(exposed.data(), exposed.data() + exposed.size())) return;
  std::vector<Index> from(exposed.size());
  std::iota(from.begin(), from.end(), 0);
  std::sort(from.begin(), from.end(), [&](Index a, Index b) { return exposed[a] < exposed[b]; });
  keep_exposed(s, from);
}

void hide(State& s, const std::vector<Flag>& hidden) {
  const Index count = Index(s.search.exposed_face.size());
  const auto leaves = [&](Index x) { return hidden[s.search.exposed_face[x]] != 0; };
  std::vector<Index> from;
  for (Index x = 0; x < count; ++x)
    if (!leaves(x)) from.push_back(x);
  for (Index slot = 0; slot < 4 * count; ++slot) {
    const Index target = s.springs.target[slot];
    if (target < 0 || !leaves(target)) continue;
    s.springs.target[slot] = s.springs.target_before[slot] = -1;
    for (Column<Real>* rows : {&s.springs.state, &s.springs.reaction, &s.springs.rolling})
      for (std::size_t k = 8 * std::size_t(slot); k < 8 * std::size_t(slot) + 8; ++k)
        if (k < rows->size()) (*rows)[k] = 0;
  }
  keep_exposed(s, from);
}

void list_exposed(const Model& m, State& s) {
  const SearchState& search = s.search;
  const std::size_t count = search.exposed_face.size();
  s.search.exposed.resize(count);
  for (std::size_t x = 0; x < count; ++x) {
    const Index face = search.exposed_face[x];
    ExposedRow& row = s.search.exposed[x];
    const Index* nodes = m.face_nodes.data() + 4 * std::size_t(face);
    for (Index k = 0; k < 4; ++k) {
      const Index across = search.across[4 * x + k];
      row.corner[k] = nodes[k] < 0 ? nodes[2] : nodes[k];
      row.beside[k] = across < 0 ? -1 : search.face_exposed[across];
    }
    row.reach = m.face_reach[face];
    row.area = m.face_area[face] / row.count();
    row.stiffness = m.face_stiffness[face];
    row.interface_class = m.face_interface_class[face];
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
