// column_info.hpp - description of an array of model or state.
#pragma once

#include <array>
#include <string>

#include "core/base/lanes.hpp"

namespace cdem {

/// How the numbers lie in memory.
enum class Layout {
  rows,     // row after row
  columns,  // number after number, each for all rows and padded, see padded_stride
  starts,   // where the list of each row begins, and where the last one ends
};

/// When a stage of a run may hand an array of the model over again.
enum class Changes {
  never,
  with_stage,   // in every stage that changes a value of the case
  with_places,  // where groups come in besides, which are free of stress where they lie then
};

/// Numbers of a row that mean one thing, a component each; a pad has the name "".
struct Part {
  constexpr Part(const char* part = nullptr, Index components = 1)
      : name(part), numbers(components) {}
  const char* name;
  Index numbers;
};

/// Contents of an array. Kinds of rows are listed in describe_rows.
struct ColumnInfo {
  std::string name = {};
  const char* unit = "1";  // of all numbers, or one for each part, with commas between
  const char* meaning = "";
  std::string rows = {};  // kind of its rows; none: a list with a length of its own
  Index numbers = 1;      // of a row
  Part parts[8] = {};     // their meanings, one after the other; none: all mean the same
  Layout layout = Layout::rows;
  // kind of rows that its indices mean: one for all numbers, or one for each; -1 means none
  std::array<std::string, 4> refers_to = {};
  bool opposite = false;  // index ~i means the negative of row i
  bool optional = false;  // empty where nothing asks for it
  Changes changes = Changes::never;
  Index initial = 0;  // number of a row that comes later, of an exposed face
};

/// A kind of rows.
struct RowKind {
  std::string name;
  const char* meaning;
};

/// Kind of rows for blocks of `block_size` consecutive rows of another kind, see Blocks.
inline std::string blocks_of(const std::string& rows) { return rows + "/8"; }

}  // namespace cdem
