// data.hpp - the arrays of columns of ground, and their functions for the engine, see
// model/module.hpp.
#pragma once

#include <vector>

#include "core/base/column.hpp"
#include "core/base/device.hpp"
#include "core/model/column_info.hpp"
#include "core/records/module_ports.hpp"
#include "core/records/rules.hpp"

namespace cdem {

struct Model;
struct State;
struct Columns;

/// Columns, their layers from the foot up, and the nodes of sides that they act on.
struct ColumnSet {
  using Module = Columns;
  Index count = 0, side_count = 0;
  Column<Index> level_first;  // [column + 1]
  Column<Real> layer;         // [level] rows of 4, of the layer above it; see Layers
  Column<Flag> bond;          // [level] 1: that layer is a bond
  Column<Real> mass;          // [level]  [kg/m2]
  Column<Real> foot;          // [column] rows of 4, see AdvanceColumns
  Column<Index> input_first, input_curve;
  Column<Real> input;    // rows of 4
  Column<Flag> acts;     // [column]
  Column<Index> node;    // [side] node of the model
  Column<Index> level;   // [side]
  Column<Real> part;     // [side]
  Column<Real> dashpot;  // [side] rows of 8
  Column<Index> layer_first, side_layer;
  Column<Real> area;  // rows of 4
};

struct ColumnState {
  using Module = Columns;
  Column<Real> displacement, before, after;  // [level] rows of 4, see ColumnMotion
  Column<Real> branch;                       // [level] three rows of 4; empty: no Maxwell branches
  Column<Index> made;                        // [column] step of `after`, or -1
};

/// Ground beside the sides of a model, which shakes as it would without the model.
struct Columns {
  using Given = ColumnSet;
  using State = ColumnState;
  static constexpr const char* name = "columns";
  static constexpr Port port = Port::applied;
  static constexpr Stage stage = Stage::before_contacts;

  static bool is_there(const Given& g) { return g.count > 0; }
  static void take_counts(Given& g, const auto& number) {
    g.count = number("columns.count");
    g.side_count = number("columns.side_count");
  }
  /// A row for each node of a side.
  static std::vector<Index> row_nodes(const Model& model, const cdem::State& state);
  /// Columns are at rest.
  static void start(const Model& model, cdem::State& state);
  /// Move the columns, then act on the sides.
  static void act(const Model& model, cdem::State& state, Queue queue);
  /// Bound of the highest frequency of the columns that move, squared, for rock whose moduli are so
  /// much higher in fast motion  [1/s2].
  static Real frequency_squared(const Given& g, Real stiffer);

  template <class Visit>
  static void describe_rows(const Given& g, Visit&& visit) {
    visit(RowKind{"columns", "columns of ground beside sides"}, g.count);
    visit(RowKind{"column_levels", "levels of columns, from the foot up"}, Index(g.mass.size()));
    visit(RowKind{"column_inputs", "motions at the feet of columns"}, Index(g.input_curve.size()));
    visit(RowKind{"column_sides", "nodes of sides with a column"}, g.side_count);
    visit(RowKind{"column_sides.layers", "layers beside these nodes"}, Index(g.side_layer.size()));
  }
  template <class Visit>
  static void describe(auto& g, State& s, const Visit& visit) {
    describe_columns(g, visit.given);
    describe_sides(g, visit.given);
    const auto level = [&](const char* name, const char* unit, const char* part,
                           const char* meaning, auto& column) {
      visit.stored({.name = name,
                    .unit = unit,
                    .meaning = meaning,
                    .rows = "column_levels",
                    .numbers = 4,
                    .parts = {{part, 3}, ""},
                    .optional = true},
                   column);
    };
    level("columns.displacement", "m, -", "displacement", "displacement x y z, and a pad",
          s.displacement);
    level("columns.before", "m/s, -", "velocity", "velocity half a step before, and a pad",
          s.before);
    level("columns.after", "m/s, -", "velocity", "velocity half a step after, and a pad", s.after);
    visit.stored(
        {.name = "columns.branch",
         .unit = "1, -",
         .meaning = "slopes of the springs of Maxwell branches in the layer above, with pads",
         .rows = "column_levels",
         .numbers = 4 * MaxwellBranches::count,
         .optional = true},
        s.branch);
    visit.stored({.name = "columns.made",
                  .meaning = "step of the velocity after it, or -1",
                  .rows = "columns",
                  .optional = true},
                 s.made);
  }

 private:
  static void describe_columns(auto& g, const auto& given) {
    given({.name = "columns.level_first",
           .meaning = "levels of a column",
           .rows = "columns",
           .layout = Layout::starts,
           .refers_to = {"column_levels"},
           .optional = true},
          g.level_first);
    given({.name = "columns.layer",
           .unit = "m, Pa, Pa, Pa",
           .meaning = "layer above a level: height, lambda + 2 mu, lambda, mu",
           .rows = "column_levels",
           .numbers = 4,
           .parts = {"height", "modulus", "lambda", "shear_modulus"},
           .changes = Changes::with_stage},
          g.layer);
    given({.name = "columns.bond",
           .meaning = "1: the layer above a level is the bond of two groups",
           .rows = "column_levels"},
          g.bond);
    given({.name = "columns.mass",
           .unit = "kg/m2",
           .meaning = "mass of a level",
           .rows = "column_levels"},
          g.mass);
    given({.name = "columns.foot",
           .unit = "kg/(m2 s), 1",
           .meaning = "dashpots of the foot x y z; 1: its motion is given",
           .rows = "columns",
           .numbers = 4,
           .parts = {{"dashpots", 3}, "driven"}},
          g.foot);
    given({.name = "columns.input_first",
           .meaning = "motions of a foot",
           .rows = "columns",
           .layout = Layout::starts,
           .refers_to = {"column_inputs"},
           .optional = true},
          g.input_first);
    given({.name = "columns.input_curve",
           .meaning = "curve of the record",
           .rows = "column_inputs",
           .refers_to = {"curves"},
           .changes = Changes::with_stage},
          g.input_curve);
    given({.name = "columns.input",
           .unit = "Pa or m/s, -",
           .meaning = "traction, or velocity of a driven foot, for a record of 1 m/s, and a pad",
           .rows = "column_inputs",
           .numbers = 4,
           .parts = {{"input", 3}, ""}},
          g.input);
    given({.name = "columns.acts",
           .meaning = "1: the column moves",
           .rows = "columns",
           .changes = Changes::with_stage},
          g.acts);
  }
  static void describe_sides(auto& g, const auto& given) {
    given({.name = "columns.node",
           .meaning = "node of the side",
           .rows = "column_sides",
           .refers_to = {"nodes"}},
          g.node);
    given({.name = "columns.level",
           .meaning = "level below the node, or beside it",
           .rows = "column_sides",
           .refers_to = {"column_levels"}},
          g.level);
    given({.name = "columns.part",
           .meaning = "way from that level to the next one above",
           .rows = "column_sides"},
          g.part);
    given({.name = "columns.dashpot",
           .unit = "kg/s, -",
           .meaning = "dashpots between node and column, xx yy zz xy yz zx, and two pads",
           .rows = "column_sides",
           .numbers = 8,
           .parts = {{"dashpots", 6}, {"", 2}}},
          g.dashpot);
    given({.name = "columns.layer_first",
           .meaning = "layers beside a node",
           .rows = "column_sides",
           .layout = Layout::starts,
           .refers_to = {"column_sides.layers"},
           .optional = true},
          g.layer_first);
    given({.name = "columns.side_layer",
           .meaning = "level below the layer",
           .rows = "column_sides.layers",
           .refers_to = {"column_levels"}},
          g.side_layer);
    given({.name = "columns.area",
           .unit = "m2, -",
           .meaning = "outward area of the node's share of the faces in the layer, x y, two pads",
           .rows = "column_sides.layers",
           .numbers = 4,
           .parts = {{"area", 2}, {"", 2}}},
          g.area);
  }
};

}  // namespace cdem
