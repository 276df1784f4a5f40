// bonded_view.hpp - kernels' view of the faces and vertices that bonds of overlapping faces hold.
#pragma once

#include <cstdint>

#include "core/base/lanes.hpp"

namespace cdem {

/// Two indices as one number.
CDEM_HD inline std::uint64_t key_of(Index a, Index b) {
  return std::uint64_t(std::uint32_t(a)) << 32 | std::uint32_t(b);
}

/// Is a key among ascending ones? Not std::binary_search, whose steps CUDA 13 leaves out in a
/// kernel, without a word.
CDEM_HD inline bool has_key(const std::uint64_t* keys, Index count, std::uint64_t key) {
  Index low = 0, high = count;
  while (low < high) {
    const Index middle = low + (high - low) / 2;
    if (keys[middle] < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && keys[low] == key;
}

/// Which faces and vertices bonds hold, see Bonded.
struct BondedView {
  const std::uint64_t *face_keys, *vertex_keys;
  Index face_count, vertex_count;

  /// Do bonds hold exposed face x to y?
  CDEM_HD bool faces(Index x, Index y) const {
    return has_key(face_keys, face_count, key_of(x, y));
  }
  /// Do bonds hold a face with this node to exposed face y?
  CDEM_HD bool vertices(Index node, Index y) const {
    return has_key(vertex_keys, vertex_count, key_of(node, y));
  }
};

}  // namespace cdem
