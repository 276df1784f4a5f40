// describe_modules.hpp - the arrays of modules: part of describe_model.hpp and describe_state.hpp.
#pragma once

#include "core/model/column_info.hpp"
#include "core/model/model.hpp"
#include "core/model/rebuilds.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// What becomes of arrays that the model has, that a checkpoint keeps, and that are made again.
template <class Given, class Stored, class Rebuilt>
struct ArrayVisit {
  const Given& given;
  const Stored& stored;
  const Rebuilt& rebuilt;
};

/// Call given(info, column) for what modules have in the model.
template <class Visit>
void describe_modules(Model& m, State& s, const Visit& given) {
  const auto skip = [](const ColumnInfo&, auto&) {};
  const auto skip_rebuilt = [](RebuiltBy, const ColumnInfo&, auto&) {};
  Modules::for_each([&]<class Module>() {
    Module::describe(given_of<Module>(m), state_of<Module>(s),
                     ArrayVisit{given, skip, skip_rebuilt});
  });
}
/// Call stored(info, column) or rebuilt(by, info, column) for what they have in the state.
template <class Stored, class Rebuilt>
void describe_modules(const Model& m, State& s, const Stored& stored, const Rebuilt& rebuilt) {
  const auto skip = [](const ColumnInfo&, auto&) {};
  Modules::for_each([&]<class Module>() {
    Module::describe(given_of<Module>(m), state_of<Module>(s), ArrayVisit{skip, stored, rebuilt});
  });
}

}  // namespace cdem
