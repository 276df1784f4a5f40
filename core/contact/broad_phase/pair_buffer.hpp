// pair_buffer.hpp - pairs that the broad phase has found, thread by thread.
#pragma once

#include <vector>

#include "core/base/lanes.hpp"
#include "core/base/uninitialized.hpp"

namespace cdem {

/// What patches may touch of the patches after them, patch after patch as one thread comes to them.
struct Proximity {
  /// A vertex of a mother face on another exposed face.
  struct Touch {
    Index mother, vertex, face;
    Index pair;  // place in the list below
  };
  /// The pair of vertex and face that touches are of, see MarkNearFaces. The room leaves some for
  /// single precision.
  struct VertexFace {
    Index of[2];  // node, exposed face
    Real room[6];
  };
  /// A pair of edges that may touch, see MarkNearEdges and EdgePairs; the same of the room.
  struct Edges {
    Index of[2];  // places of the edges in `edge_sides`
    Real room[6];
    Index code;
  };
  /// A face of which a vertex or a side is on the lists, and the one that it may touch.
  struct Meeting {
    Index mother, face;
  };
  std::vector<Touch> touches;
  std::vector<VertexFace> faces;
  std::vector<Edges> edges;
  std::vector<Meeting> meetings;

  void clear() {
    touches.clear();
    faces.clear();
    edges.clear();
    meetings.clear();
  }
};

/// All that may touch before the next refresh.
struct AllProximity {
  /// Where a patch's share of a thread's lists begins and ends.
  struct Share {
    Index thread = 0;
    Range touches{0, 0}, faces{0, 0}, edges{0, 0};

    void begin(Index of, const Proximity& lists) {
      thread = of;
      touches.first = Index(lists.touches.size()), faces.first = Index(lists.faces.size());
      edges.first = Index(lists.edges.size());
    }
    void end(const Proximity& lists) {
      touches.last = Index(lists.touches.size()), faces.last = Index(lists.faces.size());
      edges.last = Index(lists.edges.size());
    }
  };
  std::vector<Proximity> by_thread;
  std::vector<Share> by_patch;
  Unset<Index> edge_sides;  // of the edges of all patches, see EdgePairs
};

}  // namespace cdem
