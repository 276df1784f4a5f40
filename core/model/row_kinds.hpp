// row_kinds.hpp - names of kinds of rows that belong to another kind.
#pragma once

#include "core/model/column_info.hpp"

namespace cdem {

/// Kind of rows for what the nodes of fused elements sum, see FusedRows.
inline std::string fused_rows_of(const std::string& rows) { return rows + ".fused_rows"; }

/// Kinds of rows for tiles of elements, and for their nodes.
inline std::string tiles_of(const std::string& rows) { return rows + ".tiles"; }
inline std::string tile_nodes_of(const std::string& rows) { return rows + ".tile_nodes"; }

}  // namespace cdem
