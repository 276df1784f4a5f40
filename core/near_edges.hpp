// near_edges.hpp - which edges of two patches may touch before the lists are renewed. Host code.
#pragma once

namespace cdem {

struct Beyond;
struct FacePairs;
struct Finder;
struct Met;
struct Patch;
struct Proximity;

/// List the edges of one patch that may touch edges of another.
void list_edges(const Finder& finder, const Patch& a, const Patch& b, const FacePairs& pairs,
                const Beyond& beyond, Met& met, Proximity& found);

}  // namespace cdem
