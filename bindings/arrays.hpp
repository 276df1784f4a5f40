// arrays.hpp - model and state in Python: views by name, and their contents.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/model/describe.hpp"
#include "core/model/describe_rows.hpp"
#include "core/model/describe_scalars.hpp"
#include "core/model/force_sets.hpp"
#include "core/run/take_out.hpp"

namespace nb = nanobind;

namespace cdem {

/// A model and its state: the data of one simulation.
struct Core {
  Model model;
  State state;
};

using Dict = nb::typed<nb::dict, nb::str, nb::any>;
using Dicts = nb::typed<nb::list, Dict>;
/// Flat arrays that Python may write into, by name.
using Views = nb::typed<nb::dict, nb::str, nb::ndarray<nb::numpy>>;
using ViewAndDict = nb::typed<nb::tuple, nb::ndarray<nb::numpy>, Dict>;

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
nb::ndarray<nb::numpy, T> array_of(std::vector<T>&& numbers) {
  auto* kept = new std::vector<T>(std::move(numbers));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  const std::size_t shape[1] = {kept->size()};
  return nb::ndarray<nb::numpy, T>(kept->data(), 1, shape, owner);
}

template <class T>
void copy(nb::handle from, Column<T>& column) {
  const auto array = nb::cast<Array<T>>(from);
  column.assign(array.data(), array.size());
}

/// Names of arrays of modules missing in the dict: the case has no items of these modules.
inline std::set<std::string> without_modules(Core& core, const Views& arrays) {
  std::set<std::string> missing;
  const auto look = [&](auto&& describe) {
    std::set<std::string> names;
    bool given = false;
    describe([&](const ColumnInfo& info, const auto&) {
      names.insert(info.name);
      given = given || arrays.contains(info.name.c_str());
    });
    if (!given) missing.merge(names);
  };
  Modules::for_each([&]<class Module>() {
    look([&](const auto& visit) {
      const auto skip = [](const ColumnInfo&, const auto&) {};
      const auto skip_rebuilt = [](RebuiltBy, const ColumnInfo&, const auto&) {};
      Module::describe(given_of<Module>(core.model), state_of<Module>(core.state),
                       ArrayVisit{visit, skip, skip_rebuilt});
    });
  });
  return missing;
}

/// Names of the stored arrays of modules that the case does not have.
inline std::vector<std::string> absent_fields(Core& core) {
  std::vector<std::string> names;
  const auto note = [&](const ColumnInfo& info, const auto&) { names.push_back(info.name); };
  const auto skip = [](const ColumnInfo&, const auto&) {};
  const auto skip_rebuilt = [](RebuiltBy, const ColumnInfo&, const auto&) {};
  Modules::for_each([&]<class Module>() {
    auto& given = given_of<Module>(core.model);
    if constexpr (Module::port == Port::applied) {
      if (Module::is_there(given)) return;
      describe_forces(Module::name, applied_of<Module>(core.state), note, skip_rebuilt);
    } else if (given.count > 0) {
      return;
    }
    Module::describe(given, state_of<Module>(core.state), ArrayVisit{skip, note, skip_rebuilt});
  });
  return names;
}

/// Copy every array of the model from a dict of flat arrays. Those of a module may be missing, all
/// of them; another missing one is our own mistake.
inline void take_model(Core& core, const Views& arrays) {
  const std::set<std::string> missing = without_modules(core, arrays);
  describe_model(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    if (!missing.contains(info.name)) copy(arrays[info.name.c_str()], column);
  });
  for_each_element_set(core.model, core.state,
                       [](const auto& kind, ElementSet& e, const ElementState&) {
                         e.points = kind.points;  // one where there are hourglass springs
                       });
}

/// Views of the model's arrays; only until one of them is changed.
inline Views model_arrays(nb::handle_t<Core> self) {
  Core& core = nb::cast<Core&>(self);
  Views arrays;
  describe_model(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    arrays[info.name.c_str()] = view(column, self);
  });
  return arrays;
}

/// Copy the arrays of the dict into the model; one that no stage may change is our own
/// mistake.
inline void update_model(Core& core, const Views& arrays) {
  std::size_t taken = 0;
  describe_model(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    if (info.changes == Changes::never || !arrays.contains(info.name.c_str())) return;
    copy(arrays[info.name.c_str()], column);
    ++taken;
  });
  if (taken != arrays.size()) throw nb::key_error("an array that no stage may change");
  hold_taken_out(core.model, core.state);
}

/// Views of the arrays that a checkpoint keeps; only until one of them is resized.
inline Views stored_arrays(nb::handle_t<Core> self) {
  Core& core = nb::cast<Core&>(self);
  Views arrays;
  describe_stored(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    arrays[info.name.c_str()] = view(column, self);
  });
  return arrays;
}

/// Views of the arrays that the core rebuilds from the others; the same holds for them.
inline Views rebuilt_arrays(nb::handle_t<Core> self) {
  Core& core = nb::cast<Core&>(self);
  Views arrays;
  describe_rebuilt(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    arrays[info.name.c_str()] = view(column, self);
  });
  return arrays;
}

inline Dict dict_of(const ColumnInfo& info, const char* origin, const char* rebuilt_by) {
  static constexpr const char* layouts[] = {"rows", "columns", "starts"};
  static constexpr const char* changes[] = {"never", "with_stage", "with_places"};
  nb::list refers_to, parts;
  for (const std::string& kind : info.refers_to) refers_to.append(kind);
  for (const Part& part : info.parts)
    if (part.name) parts.append(nb::make_tuple(part.name, part.numbers));
  Dict one;
  one["name"] = info.name, one["unit"] = info.unit, one["meaning"] = info.meaning;
  one["rows"] = info.rows, one["numbers"] = info.numbers, one["parts"] = parts;
  one["layout"] = layouts[int(info.layout)];
  one["refers_to"] = refers_to, one["opposite"] = info.opposite;
  one["optional"] = info.optional, one["changes"] = changes[int(info.changes)];
  one["origin"] = origin, one["rebuilt_by"] = rebuilt_by;
  return one;
}

/// View of one array, valid until it is changed or resized, and its contents.
inline ViewAndDict array_by_name(nb::handle_t<Core> self, const std::string& name) {
  Core& core = nb::cast<Core&>(self);
  ViewAndDict found;
  const auto look = [&](const ColumnInfo& info, auto& column, const char* origin,
                        const char* by = "") {
    if (info.name == name) found = nb::make_tuple(view(column, self), dict_of(info, origin, by));
  };
  describe(
      core.model, core.state,
      [&](const ColumnInfo& info, auto& column) { look(info, column, "given"); },
      [&](const ColumnInfo& info, auto& column) { look(info, column, "stored"); },
      [&](RebuiltBy by, const ColumnInfo& info, auto& column) {
        look(info, column, "rebuilt", by.rebuild().name);
      });
  if (found.size() == 0) throw nb::key_error(name.c_str());
  return found;
}

/// Contents and origin of every array.
inline Dicts describe_arrays(Core& core) {
  Dicts infos;
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
inline Dicts describe_row_kinds(Core& core) {
  Dicts kinds;
  describe_rows(core.model, core.state, [&](const RowKind& kind, Index count) {
    nb::dict one;
    one["name"] = kind.name, one["meaning"] = kind.meaning, one["count"] = count;
    kinds.append(one);
  });
  return kinds;
}

/// Bring back the arrays and scalars of a checkpoint.
inline void restore(Core& core, const Views& arrays, const Dict& scalars) {
  describe_stored(core.model, core.state, [&](const ColumnInfo& info, auto& column) {
    if (arrays.contains(info.name.c_str())) copy(arrays[info.name.c_str()], column);
  });
  describe_scalars(core.state, [&]<class T>(const ScalarInfo& info, T& number) {
    number = nb::cast<T>(scalars[info.name]);
  });
  core.state.search.inner.known = core.state.search.inner.held_known = false;  // of another state
  core.state.search.joined_faces = -1;
}

inline Dict scalars(Core& core) {
  Dict numbers;
  describe_scalars(
      core.state, [&](const ScalarInfo& info, const auto& number) { numbers[info.name] = number; });
  return numbers;
}

inline Dicts scalar_infos(Core& core) {
  Dicts infos;
  describe_scalars(core.state, [&](const ScalarInfo& info, const auto&) {
    nb::dict one;
    one["name"] = info.name, one["unit"] = info.unit, one["meaning"] = info.meaning;
    infos.append(one);
  });
  return infos;
}

}  // namespace cdem
