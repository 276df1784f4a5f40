// exposed.hpp - exposed faces as the lists of the search see them: where they are, and how they may
// move before the lists are renewed. Host code.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "core/contact/boxes.hpp"
#include "core/contact/face.hpp"
#include "core/model.hpp"
#include "core/state.hpp"

namespace cdem {

/// A vector for loops to fill: its items begin as the memory is, for to fill them twice, at first
/// on one thread, costs as much as what the loops do.
template <class T>
struct LeaveUnset : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = LeaveUnset<U>;
  };
  void construct(T* item) { ::new (static_cast<void*>(item)) T; }
};
template <class T>
using Unset = std::vector<T, LeaveUnset<T>>;

/// A node of exposed faces as the lists see it: they are old once it is farther than its skin from
/// where it went straight on.
struct WatchedNode {
  Vec3<Real> position;  // when the lists were made  [m]
  Vec3<Real> velocity;  // foreseen  [m/s]
  Real skin;            // [m]

  static WatchedNode of(const State& s, Index node) {
    const Real* r = s.search.watch.data() + 8 * std::size_t(s.search.node_watch[node]);
    return {{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, r[7]};
  }
  void store(Real* r) const {
    r[0] = position.x, r[1] = position.y, r[2] = position.z, r[3] = skin * skin;
    r[4] = velocity.x, r[5] = velocity.y, r[6] = velocity.z, r[7] = skin;
  }
};

/// The lists of what is close look ahead for such a part of the horizon, and give every vertex such
/// a part of its skin at most, see close_lists.hpp.
inline constexpr Real close_way = 0.06, close_skin = 0.5;

/// Foresee where the nodes of exposed faces go, straight on with the rigid motion of their elements
/// (which leaves the elements' vibrations out), and how far they may stray from there: as far as
/// they would with the change of velocity that they had since the last refresh.
void foresee_motion(const Model& model, State& state);

/// Let nodes know their places among those that are watched.
void place_watched(const Model& model, State& state);

/// An exposed face as the lists see it: where it is, and how it may move before they are old.
struct ExposedFace {
  FaceShape<Real> shape;
  Vec3<Real> center, normal;
  Vec3<Real> drift;           // of all its vertices alike  [m]
  Real stir;                  // of a vertex beyond the drift  [m]
  Real turn;                  // of the normal and of the sides  [rad]
  Real stir_soon, turn_soon;  // as long as the close lists hold
  Real slender;               // longest side over smallest height
  Real deepest;               // contact  [m]
  Real warp;                  // of a vertex out of the mean plane  [m]
  Real length;                // L  [m]
  Index face, block;
  bool movable;
  Box box;  // of the whole way
};

void list_exposed_faces(const Model& model, const State& state, Unset<ExposedFace>& exposed);

/// What the indentation of the faces at an edge takes from the ends of the edge, at least, and how
/// far it moves it aside, at most, with room for what faces are strained; least L  [m].
struct Indented {
  Real inset = 1e300, shift = 0, length = 1e300;

  Indented and_of(const Indented& other) const {
    return {std::min(inset, other.inset), std::max(shift, other.shift),
            std::min(length, other.length)};
  }
};

/// The exposed faces of one element, with their vertices and edges, each once.
struct Patch {
  /// An edge: the faces of the patch that meet there, and which of their sides it is.
  struct Edge {
    Index id, faces;
    Index face[2], side[2];
    Index vertex[2];
    Indented indented;
  };
  Index face_count, vertex_count, edge_count;
  Index face[6];  // exposed
  Index vertex[8];
  Index corner[8][6];  // which corner of a face a vertex is, or -1
  Edge edge[12];
  Index edge_first;    // place of the first among those of all patches
  Vec3<Real> drift;    // of all its vertices alike  [m]
  Real stir;           // of a vertex beyond the drift  [m]
  Real deepest;        // contact  [m]
  Real length, reach;  // largest of its faces  [m]
  Index block;
  bool movable;
  bool whole;  // are all faces of the element exposed?
  Box box;     // of the whole way
};

/// Group the exposed faces by the elements behind them.
void list_patches(const Model& model, const State& state, const Unset<ExposedFace>& exposed,
                  Unset<Patch>& patches);

/// A side of an exposed face. The faces that meet there fall away from a contact: its normal must
/// lie between theirs, which is what `fall` tells (see TouchTargetEdges::cones_hold).
struct ExposedSide {
  bool sharp;  // may be an edge of a contact: its faces are not coplanar
  bool rises;  // may be where the surface bends towards its outside
  Vec3<Real> start, along;
  Vec3<Real> fall, fall_across;       // normal x side, of the face and of the one across
  Index across;                       // exposed face on the other side, or -1
  Real length;                        // [m]
  Real turn, turn_face, turn_across;  // of the side and of both faces
};

void list_exposed_sides(const State& state, const Unset<ExposedFace>& exposed,
                        Unset<ExposedSide>& sides);

}  // namespace cdem
