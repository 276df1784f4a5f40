// bonded_overlaps.hpp - faces and vertices that bonds of overlapping faces keep from the search.
#pragma once

#include <cstdint>

#include "core/base/column.hpp"
#include "core/bonds/bonded_view.hpp"
#include "core/records/pair_status.hpp"

namespace cdem {

struct Model;
struct State;

/// Faces and vertices that bonds of overlaps hold, hinges left out, as ascending keys.
struct Bonded {
  Column<std::uint64_t> faces;     // exposed face and the one it is bonded to
  Column<std::uint64_t> vertices;  // node of a bonded face and exposed face that it is bonded to

  BondedView view() const {
    return {.face_keys = faces.data(),
            .vertex_keys = vertices.data(),
            .face_count = Index(faces.size()),
            .vertex_count = Index(vertices.size())};
  }
};
Bonded live_overlaps(const Model& model, const State& state);

/// Is a pair bonded, and no hinge?
struct IsBonded {
  const Flag* status;
  CDEM_HD bool operator()(One pair) const {
    return PairStatus(status[pair.i]) == PairStatus::bonded;
  }
};

/// Write the keys of the sides of bonded overlaps: 2 of faces and 8 of vertices each.
struct WriteBondedKeys {
  const Index* bonded;        // numbers of overlaps
  const Index* pair_faces;    // [overlap][2]
  const Index* face_nodes;    // [face][4]
  const Index* face_exposed;  // place or -1
  std::uint64_t *faces, *vertices;

  CDEM_HD void operator()(One item) const {
    const Index* const pair = pair_faces + 2 * std::size_t(bonded[item.i]);
    for (Index side = 0; side < 2; ++side) {
      const std::size_t row = 2 * std::size_t(item.i) + side;
      const Index face = pair[side], mate = face_exposed[pair[1 - side]];
      faces[row] = key_of(face_exposed[face], mate);
      for (Index k = 0; k < 4; ++k)
        vertices[4 * row + k] = key_of(face_nodes[4 * std::size_t(face) + k], mate);
    }
  }
};

}  // namespace cdem
