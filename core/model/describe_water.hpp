// describe_water.hpp - the arrays of water: part of describe_model.hpp and describe_state.hpp.
#pragma once

#include "core/model/column_info.hpp"
#include "core/model/model.hpp"
#include "core/model/state.hpp"

namespace cdem {

/// What of them joints keep, and which faces lie on them: part of `describe_wet`.
template <class Visit>
void describe_wet_joints(const char* rows, WetFaces& w, Visit&& given) {
  const std::string set = std::string(rows) + ".";
  given({.name = set + "kept",
         .unit = "Pa",
         .meaning = "pressure at a vertex that fields keep, at the start",
         .rows = rows,
         .numbers = w.vertices,
         .layout = Layout::columns,
         .optional = true,
         .changes = Changes::with_stage},
        w.kept);
  given({.name = set + "aperture",
         .unit = "m",
         .meaning = "up to which an open joint keeps its water",
         .rows = rows,
         .changes = Changes::with_stage},
        w.aperture);
  given({.name = set + "pair_first",
         .meaning = "what lies on a face at the start",
         .rows = rows,
         .layout = Layout::starts,
         .refers_to = {set + "pairs"},
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

/// Faces that water may press on: part of `describe_model`.
template <class Visit>
void describe_wet(const char* rows, WetFaces& w, Visit&& given) {
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
  describe_wet_joints(rows, w, given);
}

/// Water: part of `describe_model`.
template <class Visit>
void describe_water(Water& w, Visit&& given) {
  describe_wet("wet_triangles", w.triangles, given);
  describe_wet("wet_quads", w.quads, given);
  given({.name = "water.fields",
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
         .meaning = "pressure in the pores that fields keep, at the start",
         .rows = "nodes",
         .optional = true,
         .changes = Changes::with_stage},
        w.node_kept);
  given({.name = "water.node_first",
         .meaning = "forces of water on a node",
         .rows = "nodes",
         .layout = Layout::starts,
         .refers_to = {"node_water"},
         .optional = true,
         .changes = Changes::with_stage},
        w.node_first);
  given({.name = "water.row",
         .meaning = "row that the node adds",
         .rows = "node_water",
         .refers_to = {"water_rows"},
         .changes = Changes::with_stage},
        w.row);
}

/// Water: part of `describe_state`.
template <class Stored, class Rebuilt>
void describe_water(const Model& m, State& s, Stored&& stored, Rebuilt&& rebuilt) {
  stored({.name = "node.water",
          .unit = "N, -",
          .meaning = "force of water, x y z, and a pad",
          .rows = "nodes",
          .numbers = 4,
          .parts = {{"force", 3}, ""},
          .optional = true},
         s.nodes.water);
  stored({.name = "node.work_water",
          .unit = "J",
          .meaning = "work of water",
          .rows = "nodes",
          .optional = true},
         s.nodes.work_water);
  stored({.name = "water.fields_now",
          .unit = "Pa, Pa/m, 1, 1, -",
          .meaning = "pressure fields in this step, see WaterFields",
          .rows = "water_fields",
          .numbers = 8,
          .parts = {"pressure", {"slope", 3}, "keeps", "factor", {"", 2}}},
         s.water.fields);
  stored({.name = "wet_triangles.field",
          .meaning = "field that presses on a vertex",
          .rows = "wet_triangles",
          .numbers = m.water.triangles.vertices,
          .layout = Layout::columns,
          .refers_to = {"water_fields"},
          .optional = true},
         s.water.triangle_field);
  stored({.name = "wet_quads.field",
          .meaning = "field that presses on a vertex",
          .rows = "wet_quads",
          .numbers = m.water.quads.vertices,
          .layout = Layout::columns,
          .refers_to = {"water_fields"},
          .optional = true},
         s.water.quad_field);
  rebuilt("update_water",
          {.name = "water.force",
           .unit = "N, -",
           .meaning = "force of water on a vertex of a face or a node of an element, and a pad",
           .rows = "water_rows",
           .numbers = 4,
           .parts = {{"force", 3}, ""}},
          s.water.force);
  rebuilt("update_water",
          {.name = "water.node_pressure",
           .unit = "Pa",
           .meaning = "pressure in the pores",
           .rows = "nodes",
           .optional = true},
          s.water.node_pressure);
}

}  // namespace cdem
