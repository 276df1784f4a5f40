// aggregation.hpp - a coarser space for a sparse matrix: groups of rows that move as rigid bodies.
//
// Smoothed aggregation: Vanek, Mandel & Brezina (1996).
#pragma once

#include <vector>

#include "core/base/math.hpp"
#include "core/rest/block_rows.hpp"

namespace cdem {

/// Motions that cost no energy, or little: six columns for each number of a vector.
using RigidModes = std::vector<Real>;

/// Those of nodes at some places: translations and rotations; 0 where a component may not move.
RigidModes rigid_modes(const std::vector<Vec3<Real>>& place, const std::vector<Flag>& free);

/// Inverses of the blocks on the diagonal.
std::vector<Real> diagonal_inverses(const BlockRows& matrix);

/// The prolongation from aggregates to rows, with smoothed columns; `modes` become those of the
/// aggregates. Rows that nothing couples to another one belong to none.
///
/// Args: `threshold`: a block counts as a coupling if its norm is larger than this part of the mean
/// of both diagonals.
BlockRows prolongation(const BlockRows& matrix, Real threshold, RigidModes& modes);

/// The matrix on the coarser space, P^T A P; 1 on the diagonal where a column of P is zero.
BlockRows coarse_matrix(const BlockRows& matrix, const BlockRows& up, const BlockRows& down);

/// The largest eigenvalue of D^-1 A, a little too large; D^-1 from `diagonal_inverses`.
Real largest_eigenvalue(const BlockRows& matrix, const std::vector<Real>& inverse);

/// Invert a symmetric positive matrix in place; rows without a positive pivot become 0.
void invert(Index n, Real* matrix);

}  // namespace cdem
