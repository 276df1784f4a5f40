// conjugate_gradients.hpp - solve A x = b with an approximate inverse of A.
#pragma once

#include "core/rest/multigrid.hpp"

namespace cdem {

/// Vectors of a solve, kept from one to the next.
struct GradientVectors {
  Column<Real> x, r, z, p, product;
};

/// Solve for `vectors.x` until the residual, in `vectors.r` and at the start the right side, has
/// become this part of what it was. The same bits on any number of threads. Returns how many
/// iterations that took, or -1: the matrix has no answer for this right side, or `most_iterations`
/// are too few.
int solve_by_gradients(Queue queue, Multigrid& inverse, Real part, int most_iterations,
                       GradientVectors& vectors);

}  // namespace cdem
