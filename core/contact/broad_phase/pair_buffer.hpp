// pair_buffer.hpp - pairs that the broad phase has found, thread by thread.
#pragma once

#include <bit>
#include <cstddef>
#include <vector>

#include "core/base/lanes.hpp"
#include "core/base/uninitialized.hpp"

namespace cdem {

/// A list that grows without moving its items: part k has room for 2^k times as many as the first.
/// Room that nothing was written to takes no memory.
template <class T>
class PartedList {
 public:
  void push_back(const T& item) {
    if (size_ == before(parts_.size())) parts_.emplace_back().reserve(first_part << part_of(size_));
    parts_.back().push_back(item);
    ++size_;
  }
  T& operator[](std::size_t i) {
    const std::size_t part = part_of(i);
    return parts_[part][i - before(part)];
  }
  const T& operator[](std::size_t i) const { return const_cast<PartedList&>(*this)[i]; }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t first_part = 4096;
  static std::size_t part_of(std::size_t i) { return std::bit_width(i / first_part + 1) - 1; }
  static std::size_t before(std::size_t part) { return first_part * ((1UL << part) - 1); }

  std::vector<std::vector<T>> parts_;
  std::size_t size_ = 0;
};

/// Possible contacts of patches with later patches, patch after patch in the order of one thread.
struct PairBuffer {
  /// A vertex of a mother face on another exposed face.
  struct Candidate {
    Index slot;  // 4 * mother face + vertex
    Index face;
    Index pair;  // place in the list below
  };
  /// The pair of vertex and face that candidates are of, see MarkNearFaces. The room leaves some
  /// for single precision.
  struct VertexFacePair {
    Index of[2];  // node, exposed face
    float room[6];
  };
  /// A pair of edges that may touch, see MarkNearEdges and EdgePairs; the same of the room.
  struct EdgePair {
    Index of[2];  // places of the edges in `edge_sides`
    float room[6];
    Index code;
  };
  /// A face with a vertex or side on the lists, and the face that it may touch.
  struct FacePair {
    Index mother, face;
  };
  PartedList<Candidate> candidates;
  PartedList<VertexFacePair> vertex_faces;
  PartedList<EdgePair> edges;
  PartedList<FacePair> face_pairs;
};

/// All that may touch before the next rebuild.
struct PairBuffers {
  /// Where a patch's share of a thread's lists begins and ends.
  struct Share {
    Index thread = 0;
    Range candidates{0, 0}, vertex_faces{0, 0}, edges{0, 0};

    void begin(Index of, const PairBuffer& lists) {
      thread = of;
      candidates.first = Index(lists.candidates.size()),
      vertex_faces.first = Index(lists.vertex_faces.size());
      edges.first = Index(lists.edges.size());
    }
    void end(const PairBuffer& lists) {
      candidates.last = Index(lists.candidates.size()),
      vertex_faces.last = Index(lists.vertex_faces.size());
      edges.last = Index(lists.edges.size());
    }
  };
  std::vector<PairBuffer> by_thread;
  std::vector<Share> by_patch;
  Unset<Index> edge_sides;  // of the edges of all patches, see EdgePairs
};

}  // namespace cdem
