// element_patch.hpp - the exposed faces of one element: where they are, and how they may move.
#pragma once

#include <cstdint>

#include "core/contact/broad_phase/box.hpp"
#include "core/contact/geometry/face.hpp"

namespace cdem {

/// An exposed face as the lists see it: where it is, and how it may move before the next rebuild.
struct ExposedFace {
  FaceShape<Real> shape;
  Vec3<Real> center, normal;
  Vec3<Real> displacement;             // of all its vertices alike  [m]
  Real deviation;                      // of a vertex beyond the displacement  [m]
  Real rotation;                       // of the normal and of the sides  [rad]
  Real deviation_soon, rotation_soon;  // while an inner list holds
  Real slender;                        // longest side over smallest height
  Real deepest;                        // contact  [m]
  Real warpage;                        // of a vertex out of the mean plane  [m]
  Real length;                         // L  [m]
  Index face, block;
  bool movable;
  Box box;  // of the whole motion
};

/// How much the indentation of the faces at an edge takes from the ends of the edge, at least, and
/// how far it moves it aside, at most, with room for strain of the faces; least L  [m].
struct Indented {
  Real inset, shift, length;

  CDEM_HD static Indented none() { return {1e300, 0, 1e300}; }
  CDEM_HD Indented and_of(const Indented& other) const {
    return {min_of(inset, other.inset), max_of(shift, other.shift), min_of(length, other.length)};
  }
};

/// The exposed faces of one element, with their vertices and edges, each once.
struct Patch {
  using Place = std::int16_t;  // among the few of a patch or a face
  /// An edge: the faces of the patch that meet there, and which of their sides it is.
  struct Edge {
    Index id;
    Place faces;
    Place face[2], side[2];
    Place vertex[2];
    Indented indented;
  };
  Index face_count, vertex_count, edge_count;
  Index face[6];  // exposed
  Index vertex[8];
  Place corner[8][6];  // which corner of a face a vertex is, or -1
  Edge edge[12];
  Index edge_first;         // index of the first among the edges of all patches
  Vec3<Real> displacement;  // of all its vertices alike  [m]
  Real deviation;           // of a vertex beyond the displacement  [m]
  Real deepest;             // contact  [m]
  Real length, reach;       // largest of its faces  [m]
  Index block;
  bool movable;
  bool whole;  // are all faces of the element exposed?
  bool far;    // of a rank: reaches no own one before the next rebuild
  Box box;     // of the whole motion

  /// Place of a node among the vertices, or how many there are.
  CDEM_HD Index vertex_at(Index node) const {
    Index v = 0;
    while (v < vertex_count && vertex[v] != node) ++v;
    return v;
  }
  /// Place of an edge of the mesh among the edges, or how many there are.
  CDEM_HD Index edge_at(Index id) const {
    Index e = 0;
    while (e < edge_count && edge[e].id != id) ++e;
    return e;
  }
};

/// A side of an exposed face. The faces that meet there fall away from a contact: its normal must
/// lie between theirs, as given by `fall` (see ResolveTargetEdges::cones_hold).
struct ExposedSide {
  bool sharp;  // may be an edge of a contact: its faces are not coplanar
  bool rises;  // may be where the surface bends towards its outside
  Vec3<Real> start, along;
  Vec3<Real> fall, fall_across;  // normal x side, of the face and of the one across
  Index across;                  // exposed face on the other side, or -1
  Real length;                   // [m]
  Real rotation, rotation_face, rotation_across;  // of the side and of both faces
};

}  // namespace cdem
