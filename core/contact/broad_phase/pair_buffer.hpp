// pair_buffer.hpp - pairs that the broad phase has found, thread by thread.
#pragma once

#include <vector>

#include "core/base/lanes.hpp"
#include "core/base/uninitialized.hpp"

namespace cdem {

/// What patches may touch of the patches after them, patch after patch as one thread comes to them.
struct PairBuffer {
  /// A vertex of a mother face on another exposed face.
  struct Candidate {
    Index mother, vertex, face;
    Index pair;  // place in the list below
  };
  /// The pair of vertex and face that candidates are of, see MarkNearFaces. The room leaves some
  /// for single precision.
  struct VertexFacePair {
    Index of[2];  // node, exposed face
    Real room[6];
  };
  /// A pair of edges that may touch, see MarkNearEdges and EdgePairs; the same of the room.
  struct EdgePair {
    Index of[2];  // places of the edges in `edge_sides`
    Real room[6];
    Index code;
  };
  /// A face of which a vertex or a side is on the lists, and the one that it may touch.
  struct FacePair {
    Index mother, face;
  };
  std::vector<Candidate> candidates;
  std::vector<VertexFacePair> vertex_faces;
  std::vector<EdgePair> edges;
  std::vector<FacePair> face_pairs;

  void clear() {
    candidates.clear();
    vertex_faces.clear();
    edges.clear();
    face_pairs.clear();
  }
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
