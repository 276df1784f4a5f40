// block_rows.hpp - sparse matrices of small dense blocks, row by row.
#pragma once

#include <vector>

#include "core/base/column.hpp"

namespace cdem {

/// A sparse matrix whose entries are blocks of `height` x `width` numbers: 3 for the displacement
/// of a node, 6 for a rigid motion.
struct BlockRows {
  Index height = 3, width = 3, columns = 0;
  Column<Index> first{}, column{};  // [row + 1], and the columns of a row, ascending
  Column<Real> block{};             // [entry][height][width]

  Index rows() const { return Index(first.size()) - 1; }
  Index block_size_of() const { return height * width; }
};

/// y = A x, or y = b - A x; on the device.
void multiply(Queue queue, const BlockRows& a, const Real* x, Real* y);
void residual(Queue queue, const BlockRows& a, const Real* b, const Real* x, Real* y);
/// y += A x
void multiply_add(Queue queue, const BlockRows& a, const Real* x, Real* y);

/// A^T, made on the host.
BlockRows transposed(const BlockRows& a);
/// A B, made on the host; sums run in the order of the columns of A.
BlockRows product(const BlockRows& a, const BlockRows& b);

}  // namespace cdem
