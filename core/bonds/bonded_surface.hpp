// bonded_surface.hpp - bodies that intact bonds join: their points, and the surface around them.
#pragma once

#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Label the nodes that intact bonds hold together, and find the surface that they make: the edges
/// that leave every point, and the face beyond every side of an exposed face. Without it every
/// element of a bonded bed would stand by itself, and its corners would catch on what slides over.
/// All of it is unchanged until a bond breaks, a face is exposed or pairs are `released`.
void join_surfaces(const Model& model, State& state, bool released);

}  // namespace cdem
