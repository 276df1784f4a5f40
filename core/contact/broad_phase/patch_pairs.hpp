// patch_pairs.hpp - kernels that list pairs of patches whose boxes overlap.
#pragma once

#include "core/contact/broad_phase/bounding_boxes.hpp"
#include "core/contact/broad_phase/separating_planes.hpp"

namespace cdem {

/// Which patches have own faces, or own nodes, of a rank: contacts of a face act on its nodes.
struct FlagOwnPatches {
  const Patch* patches;
  const Flag *own_face, *own_node;  // [exposed], [node]
  Flag* flags;
  CDEM_HD void operator()(One i) const {
    const Patch& patch = patches[i.i];
    bool own = own_face[patch.face[0]] != 0;
    for (Index v = 0; v < patch.vertex_count; ++v) own = own || own_node[patch.vertex[v]] != 0;
    flags[i.i] = own;
  }
};
/// Patches that are not near an own one are far.
struct MarkFarPatches {
  const Flag* near;
  Patch* patches;
  CDEM_HD void operator()(One i) const { patches[i.i].far = near[i.i] == 0; }
};

/// Call act(pair) for the patches whose boxes overlap with that of a movable one: the later ones,
/// and the ones that are not movable.
struct ListPatchPairs {
  const Patch* patches;
  BoxTree tree;
  Index first = 0;  // patch of row 0

  template <class Act>
  CDEM_HD void visit(One row, const Act& act) const {
    const Index one = first + row.i;
    const Patch& patch = patches[one];
    if (!patch.movable) return;  // movable patches find it
    tree.query(patch.box, [&](Index q) {
      const Patch& other = patches[q];
      if ((q > one || !other.movable) && patch.block != other.block && !(patch.far && other.far))
        act(PatchPair{.one = one, .other = q, .edge = {}, .vertex = {}, .meets = 0, .listed = {}});
    });
  }
};

/// Sort the pairs of every patch by the other one.
struct SortByOther {
  PatchPair* pairs;
  Index count;

  CDEM_HD void operator()(One first) const {
    const Index one = pairs[first.i].one;
    if (first.i > 0 && pairs[first.i - 1].one == one) return;  // the first of a patch does so
    for (Index i = first.i + 1; i < count && pairs[i].one == one; ++i) {
      const Index other = pairs[i].other;
      Index place = i;
      for (; place > first.i && pairs[place - 1].other > other; --place)
        pairs[place].other = pairs[place - 1].other;
      pairs[place].other = other;
    }
  }
};

}  // namespace cdem
