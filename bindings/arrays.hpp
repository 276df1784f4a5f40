// arrays.hpp - model and state in Python: views by name, and their contents.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
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
  std::unique_ptr<Exchange> exchange;  // of a rank
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

/// Only the core writes such rows.
inline void copy(nb::handle, Column<ExposedRow>&) { throw nb::type_error("rows of the core"); }

/// One array of model or state, whatever its numbers are.
struct ArrayEntry {
  ColumnInfo info;
  std::variant<Column<Real>*, Column<Index>*, Column<Flag>*, Column<Short>*, Column<ExposedRow>*>
      column;
  const char* origin;           ///< "given", "stored" or "rebuilt"
  const char* rebuilt_by = "";  ///< Name of what rebuilds it.
};
using ArrayEntries = std::vector<ArrayEntry>;

/// Puts arrays on a list, all or that of one name: the one visitor of all arrays, since each takes
/// as long to compile as half of all other bindings.
struct ListArrays {
  ArrayEntries& list;
  const char* origin;
  std::string_view name = {};

  void operator()(const ColumnInfo& info, auto& column) const {
    if (name.empty() || info.name == name) list.push_back({info, &column, origin});
  }
  void operator()(RebuiltBy by, const ColumnInfo& info, auto& column) const {
    if (name.empty() || info.name == name)
      list.push_back({info, &column, origin, by.rebuild().name});
  }
};

/// Every array, in the order of the manual, or that of one name.
inline ArrayEntries array_entries(Core& core, std::string_view name = {}) {
  ArrayEntries list;
  describe(core.model, core.state, ListArrays{list, "given", name},
           ListArrays{list, "stored", name}, ListArrays{list, "rebuilt", name});
  return list;
}

/// Those of one module.
template <class Module>
ArrayEntries module_entries(Core& core) {
  ArrayEntries list;
  const ListArrays given{list, "given"}, stored{list, "stored"}, rebuilt{list, "rebuilt"};
  Module::describe(given_of<Module>(core.model), state_of<Module>(core.state),
                   ArrayVisit{given, stored, rebuilt});
  return list;
}

inline bool is_of(const ArrayEntry& one, std::string_view origin) { return one.origin == origin; }

inline nb::object view(const ArrayEntry& one, nb::handle owner) {
  return std::visit([&](auto* column) { return view(*column, owner); }, one.column);
}

inline void copy(const Views& from, const ArrayEntry& one) {
  std::visit([&]<class T>(Column<T>* column) { copy(from[one.info.name.c_str()], *column); },
             one.column);
}

/// Views of the arrays of one origin.
inline Views views_of(nb::handle_t<Core> self, std::string_view origin) {
  Views arrays;
  for (const ArrayEntry& one : array_entries(nb::cast<Core&>(self)))
    if (is_of(one, origin)) arrays[one.info.name.c_str()] = view(one, self);
  return arrays;
}

/// Names of arrays of modules missing in the dict: the case has no items of these modules.
inline std::set<std::string> without_modules(Core& core, const Views& arrays) {
  std::set<std::string> missing;
  Modules::for_each([&]<class Module>() {
    std::set<std::string> names;
    bool given = false;
    for (const ArrayEntry& one : module_entries<Module>(core)) {
      if (!is_of(one, "given")) continue;
      names.insert(one.info.name);
      given = given || arrays.contains(one.info.name.c_str());
    }
    if (!given) missing.merge(names);
  });
  return missing;
}

/// Names of the stored arrays of modules that the case does not have.
inline std::vector<std::string> absent_fields(Core& core) {
  std::vector<std::string> names;
  const auto note = [&](const ArrayEntries& list) {
    for (const ArrayEntry& one : list)
      if (is_of(one, "stored")) names.push_back(one.info.name);
  };
  Modules::for_each([&]<class Module>() {
    auto& given = given_of<Module>(core.model);
    if constexpr (Module::port == Port::applied) {
      if (Module::is_there(given)) return;
      ArrayEntries list;
      const ListArrays stored{list, "stored"}, rebuilt{list, "rebuilt"};
      describe_forces(Module::name, applied_of<Module>(core.state), stored, rebuilt);
      note(list);
    } else if (given.count > 0) {
      return;
    }
    note(module_entries<Module>(core));
  });
  return names;
}

/// Copy every array of the model from a dict of flat arrays. Those of a module may be missing, all
/// of them; another missing one is our own mistake.
inline void take_model(Core& core, const Views& arrays) {
  const std::set<std::string> missing = without_modules(core, arrays);
  for (const ArrayEntry& one : array_entries(core))
    if (is_of(one, "given") && !missing.contains(one.info.name)) copy(arrays, one);
  for_each_element_set(core.model, core.state,
                       [](const auto& kind, ElementSet& e, const ElementState&) {
                         e.points = kind.points;  // one where there are hourglass springs
                       });
}

/// Views of the model's arrays; only until one of them is changed.
inline Views model_arrays(nb::handle_t<Core> self) { return views_of(self, "given"); }

/// Copy the arrays of the dict into the model; one that no stage may change is our own
/// mistake.
inline void update_model(Core& core, const Views& arrays) {
  std::size_t taken = 0;
  for (const ArrayEntry& one : array_entries(core)) {
    if (!is_of(one, "given") || one.info.changes == Changes::never) continue;
    if (!arrays.contains(one.info.name.c_str())) continue;
    copy(arrays, one);
    ++taken;
  }
  if (taken != arrays.size()) throw nb::key_error("an array that no stage may change");
  hold_taken_out(core.model, core.state);
}

/// Views of the arrays that a checkpoint keeps; only until one of them is resized.
inline Views stored_arrays(nb::handle_t<Core> self) { return views_of(self, "stored"); }

/// Views of the arrays that the core rebuilds from the others; the same holds for them.
inline Views rebuilt_arrays(nb::handle_t<Core> self) { return views_of(self, "rebuilt"); }

inline Dict dict_of(const ArrayEntry& entry) {
  const ColumnInfo& info = entry.info;
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
  one["origin"] = entry.origin, one["rebuilt_by"] = entry.rebuilt_by;
  return one;
}

/// View of one array, valid until it is changed or resized, and its contents.
inline ViewAndDict array_by_name(nb::handle_t<Core> self, const std::string& name) {
  const ArrayEntries found = array_entries(nb::cast<Core&>(self), name);
  if (found.empty()) throw nb::key_error(name.c_str());
  return nb::make_tuple(view(found[0], self), dict_of(found[0]));
}

/// Contents and origin of every array.
inline Dicts describe_arrays(Core& core) {
  Dicts infos;
  for (const ArrayEntry& one : array_entries(core)) infos.append(dict_of(one));
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
  for (const ArrayEntry& one : array_entries(core))
    if (is_of(one, "stored") && arrays.contains(one.info.name.c_str())) copy(arrays, one);
  describe_scalars(core.state, [&]<class T>(const ScalarInfo& info, T& number) {
    number = nb::cast<T>(scalars[info.name]);
  });
  core.state.search.inner.known = core.state.search.inner.held_known = false;  // of another state
  core.state.search.joined_faces = -1;
  core.state.search.outer.skin_exceeded = false;
}
/// The same in place of whatever state the core had, as if it were new.
inline void restore_anew(Core& core, const Views& arrays, const Dict& scalars) {
  restore(core, arrays, scalars);
  core.state.nodes.lumped.resize(0);
}

/// Free the arrays of a checkpoint, until others are restored in their place.
inline void drop_state(Core& core) {
  for (const ArrayEntry& one : array_entries(core))
    if (is_of(one, "stored"))
      std::visit([]<class T>(Column<T>* column) { Column<T>().swap(*column); }, one.column);
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
