// bonded_view.hpp - kernels' view of the faces and vertices that bonds of overlapping faces hold.
#pragma once

#include <cstdint>

#include "core/base/sorted.hpp"

namespace cdem {

/// Two indices as one number.
CDEM_HD inline std::uint64_t key_of(Index a, Index b) {
  return std::uint64_t(std::uint32_t(a)) << 32 | std::uint32_t(b);
}

/// Which faces and vertices bonds hold, see Bonded.
struct BondedView {
  const std::uint64_t *face_keys, *vertex_keys;
  Index face_count, vertex_count;

  /// Do bonds hold exposed face x to y?
  CDEM_HD bool faces(Index x, Index y) const {
    return is_among(face_keys, face_count, key_of(x, y));
  }
  /// Do bonds hold a face with this node to exposed face y?
  CDEM_HD bool vertices(Index node, Index y) const {
    return is_among(vertex_keys, vertex_count, key_of(node, y));
  }
};

}  // namespace cdem
