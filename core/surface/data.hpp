// data.hpp - the arrays of surface laws, and their functions for the engine, see model/module.hpp.
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
struct Surface;

/// Faces with one number of vertices; a face with several entries is listed once for each.
struct SurfaceFaces {
  Index count = 0, stride = 0;
  Index vertices = 0, row_first = 0;  // of a face; first of its rows among the forces of the module
  Column<Index> nodes;                // [vertex][face]
  Column<Index> entry;                // [face]
  Column<Real> area;                  // [face] at the start  [m2]
  Column<Real> normal;                // [face] rows of 3: outward, at the start
  Column<Real> impedance;             // [face] rows of 2: of the rock behind it, see Impedance
};

/// Entries of the case, each a law with its parameters and a curve, and the faces they act on.
struct SurfaceSet {
  using Module = Surface;
  Index count = 0;                // entries
  Index row = 0, most_state = 0;  // numbers of an entry, and of a vertex, as laws have them at most
  SurfaceFaces triangles, quads;
  Column<Index> law, curve;  // [entry]
  Column<Real> parameters;   // [entry][row]
  Column<Flag> waits;        // [entry] 1: for a stage, see begin
};

/// Input of a law at the vertices of a set of faces.
struct SurfacePoints {
  Column<Real> place;    // [3 * vertices][face] where they lay as the entry began to act  [m]
  Column<Real> history;  // [vertices * most_state][face]; empty where no law has state
};

struct SurfaceState {
  using Module = Surface;
  SurfacePoints triangles, quads;
  Column<Flag> begun;         // [entry] 1: it acts
  Column<Real> factor, acts;  // [entry] at this time, and 1 or 0
};

/// Tractions on faces from outside, each by a law.
struct Surface {
  using Given = SurfaceSet;
  using State = SurfaceState;
  static constexpr const char* name = "surface";
  static constexpr Port port = Port::applied;
  static constexpr Stage stage = Stage::after_contacts;

  static bool is_there(const Given& g) { return g.count > 0; }
  static void take_counts(Given& g, const auto& number) {
    g.count = number("surface.count");
    take_widths(g);
    take_count(g.triangles, 3, 0, number("surface_triangles.count"));
    take_count(g.quads, 4, 3 * g.triangles.count, number("surface_quads.count"));
  }
  /// Rows of the vertices of triangles, then of quadrilaterals.
  static std::vector<Index> row_nodes(const Model& model, const cdem::State& state);
  /// Entries that wait for no stage begin to act.
  static void start(const Model& model, cdem::State& state);
  /// Forces of the laws that act now.
  static void act(const Model& model, cdem::State& state, Queue queue);
  /// Faces of nodes that come in are new to their laws where they lie now.
  static void renew(const Model& model, cdem::State& state, const Flag* comes);
  /// Entries with flag 1 begin to act: displacements count from here.
  static void begin(const Model& model, cdem::State& state, const Flag* which);
  /// Dashpots of laws that have begun to act, vertex by vertex.
  static std::vector<NodeDashpot> dashpots(const Given& g, const State& s);
  /// for_each_stiffness(visit) calls visit(node, stiffness [N/m]) for the stiffness of laws at
  /// nodes.
  static auto stiffness_of(const Given& g) {
    return [&g](auto&& visit) {
      for (const SurfaceFaces* faces : {&g.triangles, &g.quads}) {
        const auto nodes = on_host(faces->nodes), entry = on_host(faces->entry);
        const auto area = on_host(faces->area);
        for (Index f = 0; f < faces->count; ++f) {
          const Real whole = stiffness_of_entry(g, entry[f]) * area[f];
          for (Index k = 0; whole > 0 && k < faces->vertices; ++k)
            visit(nodes[std::size_t(k) * faces->stride + f], whole / faces->vertices);
        }
      }
    };
  }

  template <class Visit>
  static void describe_rows(const Given& g, Visit&& visit) {
    visit(RowKind{"surfaces", "entries of loads.surfaces"}, g.count);
    visit(RowKind{"surface_triangles", "triangles that surface laws act on"}, g.triangles.count);
    visit(RowKind{"surface_quads", "quadrilaterals that surface laws act on"}, g.quads.count);
  }
  template <class Visit>
  static void describe(auto& g, State& s, const Visit& visit) {
    visit.given({.name = "surface.law",
                 .meaning = "number of the law",
                 .rows = "surfaces",
                 .changes = Changes::with_stage},
                g.law);
    visit.given({.name = "surface.curve",
                 .meaning = "curve of its factor",
                 .rows = "surfaces",
                 .refers_to = {"curves"},
                 .changes = Changes::with_stage},
                g.curve);
    visit.given({.name = "surface.parameters",
                 .unit = "see the law",
                 .meaning = "parameters of the law",
                 .rows = "surfaces",
                 .numbers = g.row,
                 .changes = Changes::with_stage},
                g.parameters);
    visit.given(
        {.name = "surface.waits", .meaning = "1: it waits for its stage", .rows = "surfaces"},
        g.waits);
    visit.stored(
        {.name = "surface.begun", .meaning = "1: it acts", .rows = "surfaces", .optional = true},
        s.begun);
    describe_faces("surface_triangles", g.most_state, g.triangles, s.triangles, visit);
    describe_faces("surface_quads", g.most_state, g.quads, s.quads, visit);
    visit.rebuilt("act_of_modules",
                  {.name = "surface.factor", .meaning = "factor in this step", .rows = "surfaces"},
                  s.factor);
    visit.rebuilt("act_of_modules",
                  {.name = "surface.acts", .meaning = "1: acts in this step", .rows = "surfaces"},
                  s.acts);
  }

 private:
  static void take_widths(Given& g);
  static Real stiffness_of_entry(const Given& g, Index entry);  // [Pa/m]
  static void take_count(SurfaceFaces& faces, Index vertices, Index row_first, Index count) {
    faces.count = count, faces.stride = padded_stride(count);
    faces.vertices = vertices, faces.row_first = row_first;
  }
  static void describe_faces(const std::string& rows, Index most_state, auto& faces,
                             SurfacePoints& points, const auto& visit) {
    visit.given({.name = rows + ".nodes",
                 .meaning = "vertices",
                 .rows = rows,
                 .numbers = faces.vertices,
                 .layout = Layout::columns,
                 .refers_to = {"nodes"},
                 .optional = true},
                faces.nodes);
    visit.given({.name = rows + ".entry",
                 .meaning = "entry that acts on it",
                 .rows = rows,
                 .layout = Layout::columns,
                 .refers_to = {"surfaces"},
                 .optional = true},
                faces.entry);
    visit.given({.name = rows + ".area",
                 .unit = "m2",
                 .meaning = "area at the start",
                 .rows = rows,
                 .optional = true},
                faces.area);
    visit.given({.name = rows + ".normal",
                 .meaning = "outward normal at the start",
                 .rows = rows,
                 .numbers = 3,
                 .optional = true},
                faces.normal);
    visit.given({.name = rows + ".impedance",
                 .unit = "kg/(m2 s)",
                 .meaning = "density times wave speed of the rock behind it, normal and tangential",
                 .rows = rows,
                 .numbers = 2,
                 .optional = true},
                faces.impedance);
    visit.stored({.name = rows + ".place",
                  .unit = "m",
                  .meaning = "place of each vertex when the entry began to act, x y z",
                  .rows = rows,
                  .numbers = 3 * faces.vertices,
                  .layout = Layout::columns,
                  .optional = true},
                 points.place);
    visit.stored({.name = rows + ".history",
                  .unit = "see the law",
                  .meaning = "state variables of the law at each vertex",
                  .rows = rows,
                  .numbers = most_state * faces.vertices,
                  .layout = Layout::columns,
                  .optional = true},
                 points.history);
  }
};

}  // namespace cdem
