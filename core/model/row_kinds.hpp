// row_kinds.hpp - names of kinds of rows that belong to another kind.
#pragma once

#include "core/model/column_info.hpp"

namespace cdem {

/// Kind of rows that the nodes of fused elements sum, see FusedRows.
inline std::string fused_rows_of(const std::string& rows) { return rows + ".fused_rows"; }

/// Kinds of rows for tiles of elements, and for their nodes.
inline std::string tiles_of(const std::string& rows) { return rows + ".tiles"; }
inline std::string tile_nodes_of(const std::string& rows) { return rows + ".tile_nodes"; }

/// Kinds of rows that a module applies to nodes, and that a node sums of it.
inline std::string applied_rows_of(const std::string& module) { return module + "_rows"; }
inline std::string applied_lists_of(const std::string& module) { return "node_" + module; }

}  // namespace cdem
