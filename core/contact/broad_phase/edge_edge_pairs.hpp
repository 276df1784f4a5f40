// edge_edge_pairs.hpp - which edges of two patches may touch before the next rebuild.
#pragma once

namespace cdem {

struct FacePairMask;
struct ListedFacePairs;
struct PairBuffer;
struct PairContext;
struct Patch;
struct SeparatedParts;

/// List the edges of one patch that may touch edges of another.
void list_edges(const PairContext& context, const Patch& a, const Patch& b,
                const FacePairMask& pairs, const SeparatedParts& separated, ListedFacePairs& listed,
                PairBuffer& found);

}  // namespace cdem
