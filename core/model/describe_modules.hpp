// describe_modules.hpp - the arrays of modules: part of describe_model.hpp and describe_state.hpp.
#pragma once

#include "core/model/column_info.hpp"
#include "core/model/model.hpp"
#include "core/model/rebuilds.hpp"
#include "core/model/row_kinds.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// Treatment of arrays of the model, of arrays in a checkpoint, and of rebuilt arrays.
template <class Given, class Stored, class Rebuilt>
struct ArrayVisit {
  const Given& given;
  const Stored& stored;
  const Rebuilt& rebuilt;
};
template <class Given, class Stored, class Rebuilt>
ArrayVisit(const Given&, const Stored&, const Rebuilt&) -> ArrayVisit<Given, Stored, Rebuilt>;

/// Call given(info, column) for arrays of modules in the model.
template <class Visit>
void describe_modules(Model& m, State& s, const Visit& given) {
  const auto skip = [](const ColumnInfo&, auto&) {};
  const auto skip_rebuilt = [](RebuiltBy, const ColumnInfo&, auto&) {};
  Modules::for_each([&]<class Module>() {
    Module::describe(given_of<Module>(m), state_of<Module>(s),
                     ArrayVisit{given, skip, skip_rebuilt});
  });
}
/// Call stored(info, column) or rebuilt(by, info, column) for their arrays in the state.
template <class Stored, class Rebuilt>
void describe_modules(const Model& m, State& s, const Stored& stored, const Rebuilt& rebuilt) {
  const auto skip = [](const ColumnInfo&, auto&) {};
  Modules::for_each([&]<class Module>() {
    Module::describe(given_of<Module>(m), state_of<Module>(s), ArrayVisit{skip, stored, rebuilt});
  });
}
/// Forces that a module applies: part of `describe_applied`.
template <class Stored, class Rebuilt>
void describe_forces(const std::string& name, AppliedForces& of, const Stored& stored,
                     const Rebuilt& rebuilt) {
  stored({.name = "node." + name,
          .unit = "N, -",
          .meaning = "force that the module applies, x y z, and a pad",
          .rows = "nodes",
          .numbers = 4,
          .parts = {{"force", 3}, ""},
          .optional = true},
         of.sum);
  stored({.name = "node.work_" + name,
          .unit = "J",
          .meaning = "work of this force",
          .rows = "nodes",
          .optional = true},
         of.work);
  rebuilt("act_of_modules",
          {.name = name + ".force",
           .unit = "N, -",
           .meaning = "force on a vertex of a face or a node of an element, and a pad",
           .rows = applied_rows_of(name),
           .numbers = 4,
           .parts = {{"force", 3}, ""}},
          of.rows);
  rebuilt("list_applied",
          {.name = name + ".node_first",
           .meaning = "rows that a node sums",
           .rows = "nodes",
           .layout = Layout::starts,
           .refers_to = {applied_lists_of(name)},
           .optional = true},
          of.first);
  rebuilt("list_applied",
          {.name = name + ".row",
           .meaning = "row that the node adds",
           .rows = applied_lists_of(name),
           .refers_to = {applied_rows_of(name)}},
          of.row);
}
/// Dashpots to the ground: part of `describe_applied`.
template <class Stored, class Rebuilt>
void describe_ground(State& s, const Stored& stored, const Rebuilt& rebuilt) {
  const auto work = [&](const char* name, const char* meaning, Column<Real>& column) {
    stored({.name = name, .unit = "J", .meaning = meaning, .rows = "nodes", .optional = true},
           column);
  };
  work("node.radiated", "work of its dashpots to the ground", s.nodes.radiated);
  work("node.radiated_sample", "its part for the coming half step", s.nodes.radiated_sample);
  rebuilt("list_ground",
          {.name = "ground.row",
           .meaning = "row of the dashpots of a node, or -1",
           .rows = "nodes",
           .refers_to = {"dashed_nodes"},
           .optional = true},
          s.ground.row);
  rebuilt("list_ground",
          {.name = "ground.node",
           .meaning = "node that has dashpots",
           .rows = "dashed_nodes",
           .refers_to = {"nodes"}},
          s.ground.node);
  rebuilt("list_ground",
          {.name = "ground.matrix",
           .unit = "kg/s, -",
           .meaning = "its dashpots, xx yy zz xy yz zx, and two pads",
           .rows = "dashed_nodes",
           .numbers = 8,
           .parts = {{"dashpots", 6}, {"", 2}}},
          s.ground.matrix);
  rebuilt("advance_nodes",
          {.name = "ground.force",
           .unit = "N, -",
           .meaning = "force of its dashpots, and a pad",
           .rows = "dashed_nodes",
           .numbers = 4,
           .parts = {{"force", 3}, ""}},
          s.ground.force);
}
/// Call the same for the forces that modules apply, with their names.
template <class Stored, class Rebuilt>
void describe_applied(State& s, const Stored& stored, const Rebuilt& rebuilt) {
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    describe_forces(Module::name, applied_of<Module>(s), stored, rebuilt);
  });
  rebuilt("add_applied",
          {.name = "node.applied",
           .unit = "N, -",
           .meaning = "sum of forces of several modules, x y z, and a pad",
           .rows = "nodes",
           .numbers = 4,
           .parts = {{"force", 3}, ""},
           .optional = true},
          s.nodes.applied);
  describe_ground(s, stored, rebuilt);
  rebuilt("list_applied",
          {.name = "node.has_applied",
           .meaning = "1: modules apply forces to it",
           .rows = "nodes",
           .optional = true},
          s.nodes.has_applied);
}

}  // namespace cdem
