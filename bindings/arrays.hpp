// arrays.hpp - model and state as Python sees them: views by name, and what they hold.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <utility>
#include <vector>

#include "core/model/describe.hpp"
#include "core/model/describe_rows.hpp"
#include "core/model/describe_scalars.hpp"
#include "core/model/force_sets.hpp"
#include "core/run/take_out.hpp"

namespace nb = nanobind;

namespace cdem {

/// A model and its state: what one simulation holds.
struct Core {
  Model model;
  State state;
};

template <class T>
using Array = nb::ndarray<const T, nb::c_contig, nb::device::cpu>;

template <class T>
nb::object view(Column<T>& column, nb::handle owner) {
  const std::size_t shape[1] = {column.size()};
  return nb::cast(nb::ndarray<nb::numpy, T>(on_host(column).data(), 1, shape, owner));
}
/// Rows that are no numbers, as bytes.
inline nb::object view(Column<ExposedRow>& column, nb::handle owner) {
  const std::size_t shape[1] = {column.size() * sizeof(ExposedRow)};
  auto* bytes = reinterpret_cast<std::uint8_t*>(on_host(column).data());
  return nb::cast(nb::ndarray<nb::numpy, std::uint8_t>(bytes, 1, shape, owner));
}

/// Numbers that Python owns from here on.
template <class T>
nb::object array_of(std::vector<T>&& numbers) {
  auto* kept = new std::vector<T>(std::move(numbers));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  const std::size_t shape[1] = {kept->size()};
  return nb::cast(nb::ndarray<nb::numpy, T>(kept->data(), 1, shape, owner));
}

template <class T>
void copy(nb::handle from, Column<T>& column) {
  const auto array = nb::cast<Array<T>>(from);
  column.assign(array.data(), array.size());
}

/// Copy every array of the model from a dict of flat arrays; a missing one is our own mistake.
inline void take_model(Core& core, const nb::dict& arrays) {
  describe_model(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    copy(arrays[info.name.c_str()], column);
  });
  for_each_element_set(core.model, core.state,
                       [](const auto& kind, ElementSet& e, const ElementState&) {
                         e.points = kind.points;  // one where there are hourglass springs
                       });
}

/// Views of the model's arrays; only until one of them is changed.
inline nb::dict model_arrays(nb::handle_t<Core> self) {
  Core& core = nb::cast<Core&>(self);
  nb::dict arrays;
  describe_model(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    arrays[info.name.c_str()] = view(column, self);
  });
  return arrays;
}

/// Copy those arrays of the model that the dict holds: what a stage may change.
inline void update_model(Core& core, const nb::dict& arrays) {
  describe_model(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    if (arrays.contains(info.name.c_str())) copy(arrays[info.name.c_str()], column);
  });
  hold_taken_out(core.model, core.state);
}

/// Views of the arrays that a checkpoint keeps; only until one of them is resized.
inline nb::dict stored_arrays(nb::handle_t<Core> self) {
  Core& core = nb::cast<Core&>(self);
  nb::dict arrays;
  describe_stored(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    arrays[info.name.c_str()] = view(column, self);
  });
  return arrays;
}

/// Views of the arrays that the core rebuilds from the others; the same holds for them.
inline nb::dict rebuilt_arrays(nb::handle_t<Core> self) {
  Core& core = nb::cast<Core&>(self);
  nb::dict arrays;
  describe_rebuilt(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    arrays[info.name.c_str()] = view(column, self);
  });
  return arrays;
}

inline nb::dict dict_of(const ColumnInfo& info, const char* origin, const char* rebuilt_by) {
  static constexpr const char* layouts[] = {"rows", "columns", "starts"};
  nb::list refers_to;
  for (const std::string& kind : info.refers_to) refers_to.append(kind);
  nb::dict one;
  one["name"] = info.name, one["unit"] = info.unit, one["meaning"] = info.meaning;
  one["rows"] = info.rows, one["numbers"] = info.numbers;
  one["layout"] = layouts[int(info.layout)];
  one["refers_to"] = refers_to, one["opposite"] = info.opposite;
  one["optional"] = info.optional, one["origin"] = origin, one["rebuilt_by"] = rebuilt_by;
  return one;
}

/// What every array holds, and where it comes from.
inline nb::list describe_arrays(Core& core) {
  nb::list infos;
  describe(
      core.model, core.state,
      [&](const ColumnInfo& info, const auto&) { infos.append(dict_of(info, "given", "")); },
      [&](const ColumnInfo& info, const auto&) { infos.append(dict_of(info, "stored", "")); },
      [&](RebuiltBy by, const ColumnInfo& info, const auto&) {
        infos.append(dict_of(info, "rebuilt", by.rebuild().name));
      });
  return infos;
}

/// The kinds of rows that arrays have: name, meaning, and how many there are now.
inline nb::list describe_row_kinds(Core& core) {
  nb::list kinds;
  describe_rows(core.model, core.state, [&](const RowKind& kind, Index count) {
    nb::dict one;
    one["name"] = kind.name, one["meaning"] = kind.meaning, one["count"] = count;
    kinds.append(one);
  });
  return kinds;
}

/// Bring back every array and scalar of a checkpoint.
inline void restore(Core& core, const nb::dict& arrays, const nb::dict& scalars) {
  describe_stored(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    copy(arrays[info.name.c_str()], column);
  });
  describe_scalars(core.state, [&]<class T>(const ScalarInfo& info, T& number) {
    number = nb::cast<T>(scalars[info.name]);
  });
}

inline nb::dict scalars(Core& core) {
  nb::dict numbers;
  describe_scalars(
      core.state, [&](const ScalarInfo& info, const auto& number) { numbers[info.name] = number; });
  return numbers;
}

inline nb::list scalar_infos(Core& core) {
  nb::list infos;
  describe_scalars(core.state, [&](const ScalarInfo& info, const auto&) {
    nb::dict one;
    one["name"] = info.name, one["unit"] = info.unit, one["meaning"] = info.meaning;
    infos.append(one);
  });
  return infos;
}

}  // namespace cdem
