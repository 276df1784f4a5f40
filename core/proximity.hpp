// proximity.hpp - what may touch before the lists of the search are renewed. Host code.
//
// The lists foresee that every vertex goes straight on at its present velocity for a while, and
// they are good until one has strayed from there by its skin. So rock that moves as a whole needs
// no new lists. Every test leaves room for that motion: what it rejects cannot come into contact
// before.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/contact/target_edge.hpp"
#include "core/exposed.hpp"
#include "core/model.hpp"
#include "core/state.hpp"

namespace cdem {

/// What live bonds of overlaps look after, as sorted keys.
struct Bonded {
  using Pairs = std::vector<std::pair<Index, Index>>;
  Pairs faces;     // exposed face and the one it is bonded to
  Pairs vertices;  // node of a bonded face and exposed face that it is bonded to

  static bool among(const Pairs& pairs, Index a, Index b) {
    return std::binary_search(pairs.begin(), pairs.end(), std::pair(a, b));
  }
};
Bonded live_overlaps(const Model& m, const State& s);

/// Side k of a face and side j of another as a candidate; false where intact bonds hold them
/// together.
bool pair_sides(const FaceColumns& faces, Index face_m, Index k, Index face_t, Index j,
                SidePair& pair);

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

/// What a search works with and what it finds. It is kept from refresh to refresh for its memory
/// only, which the system would have to hand out anew.
struct ProximitySearch {
  Unset<ExposedFace> exposed;
  Unset<ExposedSide> sides;
  Unset<Patch> patches;
  AllProximity found;
};
void find_proximity(const Model& model, const State& state, ProximitySearch& search);

}  // namespace cdem
