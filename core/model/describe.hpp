// describe.hpp - the list of all arrays of model and state.
//
// Python's views, checkpoints, tests and manual come from it: a column that is not listed here does
// not exist for them.
#pragma once

#include "core/model/describe_contacts.hpp"
#include "core/model/describe_model.hpp"
#include "core/model/describe_search.hpp"
#include "core/model/describe_state.hpp"
#include "core/model/rebuilds.hpp"

namespace cdem {

/// Call given(info, column), stored(info, column) or rebuilt(by, info, column) for every array.
template <class Given, class Stored, class Rebuilt>
void describe(Model& m, State& s, Given&& given, Stored&& stored, Rebuilt&& rebuilt) {
  describe_model(m, s, given);
  describe_state(m, s, stored, rebuilt);
  describe_contacts(s, stored, rebuilt);
  describe_search(s.search, stored, rebuilt);
}

/// Call visit(info, column) for the arrays that a checkpoint keeps.
template <class Visit>
void describe_stored(Model& m, State& s, Visit&& visit) {
  describe(
      m, s, [](const ColumnInfo&, const auto&) {}, visit,
      [](RebuiltBy, const ColumnInfo&, const auto&) {});
}

/// Call visit(info, column) for the arrays of the state that the core rebuilds from the others.
template <class Visit>
void describe_rebuilt(Model& m, State& s, Visit&& visit) {
  const auto skip = [](const ColumnInfo&, const auto&) {};
  describe(m, s, skip, skip,
           [&](RebuiltBy, const ColumnInfo& info, auto& column) { visit(info, column); });
}

}  // namespace cdem
