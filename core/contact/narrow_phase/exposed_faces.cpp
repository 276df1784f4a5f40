// exposed_faces.cpp - see exposed_faces.hpp.
#include "core/contact/narrow_phase/exposed_faces.hpp"

#include <utility>

#include "core/base/primitives.hpp"
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/edge_contacts.hpp"
#include "core/contact/narrow_phase/list_exposed.hpp"
#include "core/contact/narrow_phase/renewed_faces.hpp"
#include "core/model/describe_contacts.hpp"
#include "core/model/describe_state.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

namespace {

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

namespace {

/// Old and new places of exposed faces.
struct Places {
  Column<Index> before, to;  // see PairPlaces
};

/// Bring the faces to their new places.
Places move_faces(State& s, Column<Index>& faces) {
  SearchState& search = s.search;
  const Index count = Index(faces.size()), count_before = Index(search.exposed_face.size());
  Index* const place = search.face_exposed.data();
  Places at;
  at.before.renew(count);
  at.to.renew(count_before);
  set_all({}, count_before, at.to.data(), Index(-1));
  for_each_item(
      {}, count,
      PairPlaces{
          .face = faces.data(), .place = place, .before = at.before.data(), .to = at.to.data()});
  for_each_item(
      {}, count_before,
      LeavePlaces{.face = search.exposed_face.data(), .to = at.to.data(), .place = place});
  for_each_item({}, count, TakePlaces{faces.data(), place});
  return at;
}

/// Visits columns: those of exposed faces or their slots follow to the new places.
class Follow {
 public:
  explicit Follow(const Places& at) : at_(at) {}

  /// A list of each face has other numbers of rows, which its own function knows.
  template <class T>
  void operator()(const ColumnInfo& info, Column<T>& column) const {
    const Index slots = info.rows == "exposed" ? 1 : info.rows == "slots" ? 4 : 0;
    const bool is_there = !info.optional || column.size() > 0;
    if (slots > 0 && info.layout == Layout::rows && is_there)
      gather(slots * info.numbers, T(info.initial), info.refers_to[0] == "exposed", column);
  }

 private:
  template <class T>
  void gather(Index width, T initial, bool has_places, Column<T>& column) const {
    if (width == 0) return;
    Column<T> now;
    now.renew(at_.before.size() * width);
    for_each_item({}, Index(at_.before.size()),
                  GatherRows<T>{.from = column.data(),
                                .into = now.data(),
                                .width = width,
                                .known = Index(column.size() / width),
                                .initial = initial,
                                .before = at_.before.data(),
                                .to = has_places ? at_.to.data() : nullptr});
    column.swap(now);
  }

  const Places& at_;
};

void drop_targets(State& s, const Column<Index>& to) {
  SpringState& c = s.springs;
  for_each_item({}, Index(c.target.size()),
                DropTargetsThatLeave{.to = to.data(),
                                     .target = c.target.data(),
                                     .target_before = c.target_before.data(),
                                     .state = c.state.data(),
                                     .reaction = c.reaction.data(),
                                     .rolling = c.rolling.size() > 0 ? c.rolling.data() : nullptr});
}

}  // namespace

Column<Flag> open_faces(const State& s) {
  const Index count = Index(s.search.face_exposed.size());
  Column<Flag> open;
  open.renew(count);
  for_each_item({}, count, FlagExposed{s.search.face_exposed.data(), open.data()});
  return open;
}

void open_faces_of(const PairSet& set, const Column<Index>& pairs, Column<Flag>& open) {
  for_each_item({}, Index(pairs.size()),
                MarkFacesOfPairs{pairs.data(), set.faces.data(), open.data()});
}

void renew_exposed(const Model& m, State& s, const Column<Flag>& open) {
  const Index all = Index(s.search.face_exposed.size());
  if (!any_item({}, all, OpensOrLeaves{open.data(), s.search.face_exposed.data()})) return;
  Column<Index> faces;
  select_items({}, all, IsSet{open.data()}, faces);
  const Places at = move_faces(s, faces);
  drop_targets(s, at.to);
  move_edges(s, at.before, at.to);
  const auto skip = [](RebuiltBy, const ColumnInfo&, const auto&) {};
  const Follow follow(at);
  describe_state(m, s, follow, skip);  // the arrays of the search are made anew after a change
  describe_contacts(s, follow, skip);
  s.search.exposed_face.swap(faces);
  for (const auto& [column, width] : {std::pair{&s.face_geometry, 8}, {&s.contact_force, 16}}) {
    column->renew(width * s.search.exposed_face.size());  // every step makes them
    set_all({}, Index(column->size()), column->data(), Real(0));
  }
}

namespace {

void list_own_exposed(State& s) {
  if (!s.share.exchange) return;
  const std::size_t count = s.search.exposed_face.size();
  Column<Flag>&own = s.share.own["exposed"], &slots = s.share.own["slots"];
  own.renew(count);
  slots.renew(4 * count);
  for_each_item({}, Index(count),
                OwnExposed{.exposed_face = s.search.exposed_face.data(),
                           .own_face = s.share.counted("faces").own,
                           .own = own.data(),
                           .own_slots = slots.data()});
}

}  // namespace

void list_exposed(const Model& m, State& s) {
  list_own_exposed(s);
  SearchState& search = s.search;
  const std::size_t count = search.exposed_face.size();
  search.exposed.renew(count);
  for_each_item({}, Index(count),
                ListExposed{.exposed_face = search.exposed_face.data(),
                            .face_exposed = search.face_exposed.data(),
                            .across = search.across.data(),
                            .face_nodes = m.face_nodes.data(),
                            .face_interface_class = m.face_interface_class.data(),
                            .face_reach = m.face_reach.data(),
                            .face_area = m.face_area.data(),
                            .face_stiffness = m.face_stiffness.data(),
                            .rows = search.exposed.data()});
}

void update_face_geometry(const Model& m, State& s, Queue q) {
  const PhaseTimer timer(s, Phase::contact);
  if (has_contact_pairs(s)) launch_geometry(m, s, q, s.search.outer.face_listed.data());
}

void update_all_face_geometry(const Model& m, State& s, Queue q) {
  launch_geometry(m, s, q, nullptr);
}

}  // namespace cdem
