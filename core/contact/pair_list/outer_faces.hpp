// outer_faces.hpp - kernels that bring the pairs of the broad phase into rows of the outer list.
#pragma once

#include "core/contact/broad_phase/vertex_face_pairs.hpp"

namespace cdem {

/// A face with a vertex or side on the lists, and the face that it may touch.
struct FacePair {
  Index mother, face;
};

/// Call act(pair) for the pairs of faces on the lists of two patches.
struct ListFacePairs {
  const Patch* patches;
  const PatchPair* pairs;

  template <class Act>
  CDEM_HD void visit(One place, const Act& act) const {
    const PatchPair& pair = pairs[place.i];
    const Patch &a = patches[pair.one], &b = patches[pair.other];
    for (Index i = 0; i < a.face_count; ++i)
      for (Index j = 0; j < b.face_count; ++j) {
        if (pair.listed[0] & PatchPair::bit(i, j)) act(FacePair{a.face[i], b.face[j]});
        if (pair.listed[1] & PatchPair::bit(j, i)) act(FacePair{b.face[j], a.face[i]});
      }
  }
};

/// Rows of pairs by the face that their contacts act on, in the order of the mothers, see
/// list_rows.
struct RowOfActingFace {
  const FacePair* pairs;

  template <class Act>
  CDEM_HD void visit(One pair, const Act& act) const {
    act(pairs[pair.i].face, pair.i);
  }
  CDEM_HD bool is_before(Index one, Index other) const {
    return pairs[one].mother < pairs[other].mother;
  }
};
/// Write the mothers instead of the pairs.
struct WriteActingFaces {
  const FacePair* pairs;
  Index* acting;
  CDEM_HD void operator()(One i) const { acting[i.i] = pairs[acting[i.i]].mother; }
};

/// Rows of candidates by slot, in the order of the faces, see list_rows.
struct RowOfCandidate {
  const Candidate* candidates;

  template <class Act>
  CDEM_HD void visit(One i, const Act& act) const {
    act(candidates[i.i].slot, i.i);
  }
  CDEM_HD bool is_before(Index one, Index other) const {
    return candidates[one].face < candidates[other].face;
  }
};
/// Write the pairs of listed candidates.
struct WriteSlotPairs {
  const Candidate* candidates;
  Index* pairs;  // [listed] the candidates before
  CDEM_HD void operator()(One i) const { pairs[i.i] = candidates[pairs[i.i]].pair; }
};

/// The edges of the mesh that the edges of all patches are.
struct FindEdges {
  const Index* sides;  // see ListedEdges
  const Index* exposed_face;
  const Index* face_edges;  // see FaceColumns
  Index* edges;

  CDEM_HD void operator()(One i) const {
    const Index side = sides[2 * std::size_t(i.i)];
    edges[i.i] = face_edges[4 * exposed_face[side / 4] + side % 4];
  }
};

}  // namespace cdem
