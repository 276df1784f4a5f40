// corner_lists.cpp - see corner_lists.hpp.
#include "core/nodes/corner_lists.hpp"

#include "core/base/primitives.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/contact_corners.hpp"
#include "core/nodes/live_corners.hpp"

namespace cdem {

namespace {

void mark_live_rows(const PairSet& p, const PairState& ps, Column<Flag>& live) {
  for_each_item({}, p.count,
                MarkLiveRows{.status = ps.status.data(),
                             .first = p.corner_first,
                             .corners = p.corners,
                             .live = live.data()});
}
template <ModuleData Given>
void mark_live_rows(const Given& given, const auto& state, Column<Flag>& live) {
  if (given.count == 0) return;
  const auto is_active = activity(state);
  const auto for_each_corner_row = corner_rows_of(given);
  const auto flags = on_host(live);
  for (Index i = 0; i < given.count; ++i)
    for_each_corner_row(i, [&](Index row) { flags[row] = is_active(i); });
}

}  // namespace

void list_corners(const Model& m, State& s) {
  Column<Flag> live;
  live.renew(m.corner_rows);
  for_each_row_set(
      m, s, [&](auto, const auto& set, const auto& state) { mark_live_rows(set, state, live); });
  list_items({}, m.node_count, LiveCorners{m.corner_first.data(), m.corner.data(), live.data()},
             s.nodes.corner_first, s.nodes.corner);
}

void list_contact_corners(const Model& m, State& s) {
  const Index exposed = Index(s.search.exposed_face.size());
  list_rows({}, exposed, 4 * exposed, m.node_count,
            ContactCorners{.exposed_face = s.search.exposed_face.data(),
                           .face_nodes = m.face_nodes.data(),
                           .listed = s.search.outer.face_listed.data()},
            s.search.contact_first, s.search.contact_corner);
}

}  // namespace cdem
