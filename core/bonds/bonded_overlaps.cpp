// bonded_overlaps.cpp - see bonded_overlaps.hpp.
#include "core/bonds/bonded_overlaps.hpp"

#include "core/base/primitives.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

Bonded live_overlaps(const Model& m, const State& s) {
  Bonded bonded;
  if (m.overlaps.count == 0) return bonded;
  Column<Index> list, number;  // the numbers of keys are not used
  select_items({}, m.overlaps.count, IsBonded{s.overlaps.status.data()}, list);
  const std::size_t count = list.size();
  bonded.faces.renew(2 * count);
  bonded.vertices.renew(8 * count);
  for_each_item({}, Index(count),
                WriteBondedKeys{.bonded = list.data(),
                                .pair_faces = m.overlaps.faces.data(),
                                .face_nodes = m.face_nodes.data(),
                                .face_exposed = s.search.face_exposed.data(),
                                .faces = bonded.faces.data(),
                                .vertices = bonded.vertices.data()});
  number.renew(8 * count);
  set_all({}, Index(8 * count), number.data(), Index(0));
  sort_pairs({}, Index(2 * count), bonded.faces.data(), number.data());
  sort_pairs({}, Index(8 * count), bonded.vertices.data(), number.data());
  return bonded;
}

}  // namespace cdem
