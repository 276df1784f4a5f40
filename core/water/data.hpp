// data.hpp - the arrays of water, and its functions for the engine, see model/module.hpp.
#pragma once

#include <string>
#include <vector>

#include "core/base/column.hpp"
#include "core/base/device.hpp"
#include "core/model/column_info.hpp"
#include "core/records/module_ports.hpp"

namespace cdem {

struct Model;
struct State;
struct Water;

/// Faces with one number of vertices that water may press on, see wet_faces.hpp.
struct WetFaces {
  Index count = 0, stride = 0;
  Index vertices = 0, row_first = 0;  // of a face; first of its rows among the forces of water
  Column<Index> nodes;                // [vertex][face]
  Column<Index> face, joint, open;    // [face] the last two: fields in a joint and in the open
  Column<Flag> bonded;                // [face] 1: water of the joint presses while bonds hold
  Column<Real> kept;                  // [vertex][face] see WaterFields  [Pa]
  Column<Real> aperture;              // [face] up to which an open joint keeps its water  [m]
  // its initial neighbours: face, and 3 * pair + kind, in the order of the sets, or -1
  Column<Index> pair_first, mate, pair;
};

/// Water in joints, in pores, and in the open. Without fields there is none; the last one is dry.
struct WaterSet {
  using Module = Water;
  WetFaces triangles, quads;
  Column<Real> fields;        // rows of 8: as WaterFields, but c without lift, and per lift  [Pa]
  Column<Index> field_curve;  // [field][2] lift, factor
  Column<Real> biot;          // [material]; empty: no rock has pores
  Column<Index> node_field;   // of the pores
  Column<Real> node_kept;     // [Pa]
  Index pore_row_first = 0;   // of the rows of elements
};

struct WaterState {
  using Module = Water;
  Column<Real> fields;                       // rows of 8, see WaterFields
  Column<Index> triangle_field, quad_field;  // [vertex][face] that presses on it
  Column<Real> node_pressure;                // in the pores  [Pa]
};

/// Forces of water pressure on faces and in pores.
struct Water {
  using Given = WaterSet;
  using State = WaterState;
  static constexpr const char* name = "water";
  static constexpr Port port = Port::applied;
  static constexpr Stage stage = Stage::after_contacts;  // water of a joint needs the contacts

  static bool is_there(const Given& w) { return w.fields.size() > 0; }
  static void take_counts(Given& w, const auto& number) {
    take_count(w.triangles, 3, 0, number("wet_triangles.count"));
    take_count(w.quads, 4, 3 * w.triangles.count, number("wet_quads.count"));
    w.pore_row_first = w.quads.row_first + 4 * w.quads.count;
  }
  /// Rows of the vertices of wet faces, then of the nodes of elements with pores.
  static std::vector<Index> row_nodes(const Model& model, const cdem::State& state);
  /// Forces on faces and in pores where the nodes are now.
  static void act(const Model& model, cdem::State& state, Queue queue);

  template <class Visit>
  static void describe_rows(const Given& w, Visit&& visit) {
    visit(RowKind{"wet_triangles", "triangles that water may press on"}, w.triangles.count);
    visit(RowKind{"wet_quads", "quadrilaterals that water may press on"}, w.quads.count);
    visit(RowKind{"wet_triangles.pairs", "faces that lie on wet triangles at the start"},
          Index(w.triangles.mate.size()));
    visit(RowKind{"wet_quads.pairs", "faces that lie on wet quadrilaterals at the start"},
          Index(w.quads.mate.size()));
    visit(RowKind{"water_fields", "pressure fields; the last one is dry"},
          Index(w.fields.size() / 8));
  }
  template <class Visit>
  static void describe(auto& w, State& s, const Visit& visit) {
    describe_faces("wet_triangles", w.triangles, visit.given);
    describe_faces("wet_quads", w.quads, visit.given);
    describe_given(w, visit.given);
    describe_state(s, w, visit.stored, visit.rebuilt);
  }

 private:
  static void take_count(WetFaces& w, Index vertices, Index row_first, Index count) {
    w.count = count, w.stride = padded_stride(count);
    w.vertices = vertices, w.row_first = row_first;
  }
  static void describe_faces(const char* rows, auto& w, const auto& given) {
    const std::string set = std::string(rows) + ".";
    given({.name = set + "nodes",
           .meaning = "vertices",
           .rows = rows,
           .numbers = w.vertices,
           .layout = Layout::columns,
           .refers_to = {"nodes"},
           .optional = true,
           .changes = Changes::with_stage},
          w.nodes);
    given({.name = set + "face",
           .meaning = "face",
           .rows = rows,
           .refers_to = {"faces"},
           .changes = Changes::with_stage},
          w.face);
    given({.name = set + "joint",
           .meaning = "field of the water in its joint",
           .rows = rows,
           .refers_to = {"water_fields"},
           .changes = Changes::with_stage},
          w.joint);
    given({.name = set + "open",
           .meaning = "field of the water where the face is free",
           .rows = rows,
           .refers_to = {"water_fields"},
           .changes = Changes::with_stage},
          w.open);
    given({.name = set + "bonded",
           .meaning = "1: water of the joint presses while bonds hold, too",
           .rows = rows,
           .changes = Changes::with_stage},
          w.bonded);
    describe_joints(rows, w, given);
  }
  static void describe_joints(const char* rows, auto& w, const auto& given) {
    const std::string set = std::string(rows) + ".";
    given({.name = set + "kept",
           .unit = "Pa",
           .meaning = "initial pressure at a vertex, stored for fields",
           .rows = rows,
           .numbers = w.vertices,
           .layout = Layout::columns,
           .optional = true,
           .changes = Changes::with_stage},
          w.kept);
    given({.name = set + "aperture",
           .unit = "m",
           .meaning = "largest opening of a joint that keeps its water",
           .rows = rows,
           .changes = Changes::with_stage},
          w.aperture);
    given({.name = set + "pair_first",
           .meaning = "faces that lie on a face at the start",
           .rows = rows,
           .layout = Layout::starts,
           .refers_to = {set + "pairs"},
           .optional = true,
           .changes = Changes::with_stage},
          w.pair_first);
    given({.name = set + "mate",
           .meaning = "face that lies on it at the start",
           .rows = set + "pairs",
           .refers_to = {"faces"},
           .changes = Changes::with_stage},
          w.mate);
    given({.name = set + "pair",
           .meaning = "3 times their pair, plus its kind: triangles, quads, overlaps; -1: none",
           .rows = set + "pairs",
           .changes = Changes::with_stage},
          w.pair);
  }
  static void describe_given(auto& w, const auto& given) {
    given(
        {.name = "water.fields",
         .unit = "Pa, Pa/m, 1, Pa/m, -",
         .meaning = "pressure at the origin, its slope x y z, 1 where points keep theirs, pressure "
                    "for each metre of lift, two pads",
         .rows = "water_fields",
         .numbers = 8,
         .parts = {"pressure", {"slope", 3}, "keeps", "per_lift", {"", 2}},
         .changes = Changes::with_stage},
        w.fields);
    given({.name = "water.field_curve",
           .meaning = "curves of lift [m] and factor",
           .rows = "water_fields",
           .numbers = 2,
           .parts = {"lift", "factor"},
           .refers_to = {"curves"},
           .changes = Changes::with_stage},
          w.field_curve);
    given({.name = "water.biot",
           .meaning = "Biot's coefficient of a material",
           .rows = "materials",
           .optional = true,
           .changes = Changes::with_stage},
          w.biot);
    given({.name = "water.node_field",
           .meaning = "field of the water in the pores",
           .rows = "nodes",
           .refers_to = {"water_fields"},
           .optional = true,
           .changes = Changes::with_stage},
          w.node_field);
    given({.name = "water.node_kept",
           .unit = "Pa",
           .meaning = "initial pore pressure, stored for fields",
           .rows = "nodes",
           .optional = true,
           .changes = Changes::with_stage},
          w.node_kept);
  }
  static void describe_state(State& s, const auto& w, const auto& stored, const auto& rebuilt) {
    stored({.name = "water.fields_now",
            .unit = "Pa, Pa/m, 1, 1, -",
            .meaning = "pressure fields in this step, see WaterFields",
            .rows = "water_fields",
            .numbers = 8,
            .parts = {"pressure", {"slope", 3}, "keeps", "factor", {"", 2}}},
           s.fields);
    const auto of_vertices = [&](const std::string& rows, Index vertices, Column<Index>& field) {
      stored({.name = rows + ".field",
              .meaning = "field that presses on a vertex",
              .rows = rows,
              .numbers = vertices,
              .layout = Layout::columns,
              .refers_to = {"water_fields"},
              .optional = true},
             field);
    };
    of_vertices("wet_triangles", w.triangles.vertices, s.triangle_field);
    of_vertices("wet_quads", w.quads.vertices, s.quad_field);
    rebuilt("act_of_modules",
            {.name = "water.node_pressure",
             .unit = "Pa",
             .meaning = "pressure in the pores",
             .rows = "nodes",
             .optional = true},
            s.node_pressure);
  }
};

}  // namespace cdem
