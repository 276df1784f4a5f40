// vertex_face_pairs.hpp - which vertices of one patch may touch faces of another.
#pragma once

namespace cdem {

struct FacePairMask;
struct ListedFacePairs;
struct PairBuffer;
struct PairContext;
struct Patch;
struct SeparatedParts;

/// List the vertices of one patch that may touch faces of another.
void list_vertex_face_pairs(const PairContext& context, const Patch& a, const Patch& b,
                            const FacePairMask& pairs, const SeparatedParts& separated,
                            bool reverse, ListedFacePairs& listed, PairBuffer& found);

}  // namespace cdem
