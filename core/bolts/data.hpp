// data.hpp - the arrays of bolts, and their functions for the engine, see model/module.hpp.
#pragma once

#include <cmath>
#include <vector>

#include "core/base/column.hpp"
#include "core/bolts/states.hpp"
#include "core/model/column_info.hpp"
#include "core/records/energy_terms.hpp"
#include "core/records/module_ports.hpp"

namespace cdem {

struct Bolts;
struct Model;
struct NodeSpring;
struct State;

/// Bolts: chains of nodes, each located in an element of the rock. Points are the nodes of all
/// bolts, then two for each crossing of a joint: in the block that the bolt leaves and in the next
/// one.
struct BoltSet {
  using Module = Bolts;
  Index count = 0;
  Index corner_first = 0;               // first of its rows among the corner forces
  Column<Index> first, crossing_first;  // nodes and crossings of a bolt
  Column<Real> properties;              // rows of BoltProperties
  Column<Flag> waits;                   // 1: not installed at the start
  Column<Real> grout, end;              // [node][2] stiffness [N/m], limit [N]
  Column<Index> crossing_bar;           // [crossing] bar that leads across
  Column<Real> dowel;                   // [crossing][2] stiffness [N/m], limit [N]
  Column<Index> hosts;                  // [point][8] nodes of the rock, or -1
  Column<Real> weights;                 // [point][8]
  Column<Real> stiffness;               // [point] that it puts on the rock at most  [N/m]
};

struct BoltState {
  using Module = Bolts;
  Column<Flag> phase;                              // BoltPhase  [bolt]
  Column<Real> slip;                               // of the bolt along its axis  [node]
  Column<Real> grout_free, end_free;               // slip without force  [node]
  Column<Real> grout_force, end_force;             // [node]
  Column<Real> length, bar_free, axial_force;      // of the bar to the next node  [node]
  Column<Flag> grout_state, end_state, bar_state;  // SliderState  [node]
  Column<Flag> bar_broken;                         // BarState  [node]
  Column<Flag> grout_lost;                         // 1: its rock was excavated  [node]
  Column<Real> dowel_free, dowel_force;            // rows of 4  [crossing]
  Column<Real> stored, lost, jacked;               // [bolt]
  Column<Real> scratch;                            // rows of 8, see BoltNodeColumns  [node]
  Column<Index> awake;                             // blocks of bolts; all are computed
};

/// Nodes, and points, of all bolts.
inline Index bolt_node_count(const BoltSet& b) { return Index(b.grout.size() / 2); }
inline Index bolt_point_count(const BoltSet& b) { return Index(b.stiffness.size()); }

/// for_each_point(bolt, visit) calls visit(point) for the points of a bolt.
inline auto points_of(const BoltSet& b) {
  return [first = on_host(b.first), crossing_first = on_host(b.crossing_first),
          nodes = bolt_node_count(b)](Index bolt, auto&& visit) {
    for (Index n = first[bolt]; n < first[bolt + 1]; ++n) visit(n);
    for (Index c = 2 * crossing_first[bolt]; c < 2 * crossing_first[bolt + 1]; ++c)
      visit(nodes + c);
  };
}

/// Bolts: passive reinforcement that holds rock together.
struct Bolts {
  using Given = BoltSet;
  using State = BoltState;
  static constexpr const char* name = "bolts";
  static constexpr Port port = Port::rows;
  static constexpr Stage stage = Stage::before_contacts;
  static constexpr Index rows = 8;  // of a point: nodes of the rock that it lies between

  static void take_counts(Given& b, const auto& number) {
    b.count = number("bolts.count");
    b.corner_first = number("bolts.corner_first");
  }
  static void size(const Given& b, State& s);
  /// A bolt acts while it is installed.
  static auto activity(const State& s) {
    return [phases = on_host(s.phase)](Index bolt) {
      const BoltPhase phase = BoltPhase(phases[bolt]);
      return phase == BoltPhase::placed || phase == BoltPhase::acting;
    };
  }
  static auto rows_of(const Given& b) {
    return [for_each_point = points_of(b), hosts = on_host(b.hosts)](Index bolt, auto&& visit) {
      for_each_point(bolt, [&](Index p) {
        for (Index row = p * rows; row < (p + 1) * rows; ++row)
          if (hosts[row] >= 0) visit(hosts[row], row);
      });
    };
  }
  static auto stiffness_of(const Given& b) {
    return
        [for_each_point = points_of(b), hosts = on_host(b.hosts), stiffness = on_host(b.stiffness),
         weights = on_host(b.weights)](Index bolt, auto&& visit) {
          for_each_point(bolt, [&](Index p) {
            for (Index k = p * rows; k < (p + 1) * rows; ++k)
              if (hosts[k] >= 0) visit(hosts[k], stiffness[p] * std::abs(weights[k]));
          });
        };
  }
  template <class Visit>
  static void for_each_energy(const State& s, Visit&& visit) {
    visit(energy_term("bolts"), s.stored);
    visit(energy_term("bolt_loss"), s.lost);
    visit(energy_term("external"), s.jacked);
  }

  /// Bring all bolts that act into equilibrium and write their forces into their corner rows.
  static void act(const Model& model, cdem::State& state, Queue queue);
  /// Bars with the grout that they pull at, and dowels.
  static std::vector<NodeSpring> springs(const Model& model, cdem::State& state);
  /// Cut these bolts in excavated rock: their rest keeps holding the remaining rock.
  static void take_out(const Given& b, State& s, const std::vector<Index>& which, const Flag* out);
  /// Bolts that are not installed yet have their grout in blocks that come in.
  static void bring_in(const Given& b, State& s, const Flag* out);
  /// Install the bolts with flag 1 in the present rock, free of force except pretension.
  static void install(const Given& b, State& s, const Flag* which);
  /// Remove the bolts with flag 1: their stored energy is lost.
  static void remove(const Given& b, State& s, const Flag* which);

  template <class Visit>
  static void describe_rows(const Given& b, Visit&& visit) {
    visit(RowKind{"bolt_nodes", "nodes of bolts; bars lead to the next"}, bolt_node_count(b));
    visit(RowKind{"bolt_crossings", "joints that bolts cross"}, Index(b.crossing_bar.size()));
    visit(RowKind{"bolt_points", "nodes of bolts, then two sides of each crossing"},
          bolt_point_count(b));
  }
  template <class Visit>
  static void describe(auto& b, State& s, const Visit& visit) {
    describe_given(b, visit.given);
    describe_points(b, visit.given);
    describe_state(s, visit.stored, visit.rebuilt);
  }

 private:
  static void describe_given(auto& b, const auto& given) {
    given({.name = "bolts.first",
           .meaning = "nodes of a bolt",
           .rows = Bolts::name,
           .layout = Layout::starts,
           .refers_to = {"bolt_nodes"},
           .optional = true},
          b.first);
    given({.name = "bolts.crossing_first",
           .meaning = "crossings of a bolt with joints",
           .rows = Bolts::name,
           .layout = Layout::starts,
           .refers_to = {"bolt_crossings"},
           .optional = true},
          b.crossing_first);
    given({.name = "bolts.properties",
           .unit = "N, N, N, 1, N",
           .meaning = "E A, yield in tension and in compression, strain at rupture, pretension",
           .rows = Bolts::name,
           .numbers = 5,
           .parts = {"axial_stiffness", "yield_force", "compressive_force", "rupture_strain",
                     "pretension"}},
          b.properties);
    given({.name = "bolts.waits", .meaning = "1: not installed at the start", .rows = Bolts::name},
          b.waits);
    given({.name = "bolts.grout",
           .unit = "N/m, N",
           .meaning = "stiffness and limit of the grout at a node",
           .rows = "bolt_nodes",
           .numbers = 2,
           .parts = {"stiffness", "limit"}},
          b.grout);
    given({.name = "bolts.end",
           .unit = "N/m, N",
           .meaning = "the same for the plate or the anchor",
           .rows = "bolt_nodes",
           .numbers = 2,
           .parts = {"stiffness", "limit"}},
          b.end);
    given({.name = "bolts.crossing_bar",
           .meaning = "bar that leads across a joint, by its first node",
           .rows = "bolt_crossings",
           .refers_to = {"bolt_nodes"}},
          b.crossing_bar);
    given({.name = "bolts.dowel",
           .unit = "N/m, N",
           .meaning = "stiffness and limit of the dowel",
           .rows = "bolt_crossings",
           .numbers = 2,
           .parts = {"stiffness", "limit"}},
          b.dowel);
  }
  static void describe_points(auto& b, const auto& given) {
    given({.name = "bolts.hosts",
           .meaning = "nodes of the rock that a point lies between; -1: none",
           .rows = "bolt_points",
           .numbers = 8,
           .refers_to = {"nodes"}},
          b.hosts);
    given({.name = "bolts.weights",
           .meaning = "weights of a point on them",
           .rows = "bolt_points",
           .numbers = 8},
          b.weights);
    given({.name = "bolts.stiffness",
           .unit = "N/m",
           .meaning = "largest stiffness of a point on the rock",
           .rows = "bolt_points"},
          b.stiffness);
  }
  static void describe_nodes(State& b, const auto& stored) {
    const auto of_node = [&](const char* name, const char* unit, const char* meaning,
                             auto& column) {
      stored({.name = name, .unit = unit, .meaning = meaning, .rows = "bolt_nodes"}, column);
    };
    of_node("bolts.slip", "m", "slip of the bolt against the rock, towards the toe", b.slip);
    of_node("bolts.grout_free", "m", "slip at which the grout is free of force", b.grout_free);
    of_node("bolts.end_free", "m", "the same for the plate or the anchor", b.end_free);
    of_node("bolts.grout_force", "N", "force of the grout on the rock", b.grout_force);
    of_node("bolts.end_force", "N", "force of the plate or the anchor on the rock", b.end_force);
    of_node("bolts.length", "m", "length of the bar to the next node when it was installed",
            b.length);
    of_node("bolts.bar_free", "m", "extension at which the bar is free of force", b.bar_free);
    of_node("bolts.axial_force", "N", "force of the bar, tension positive", b.axial_force);
    of_node("bolts.grout_state", "1", "0: holds, 1, 2: slips towards the toe, the head",
            b.grout_state);
    of_node("bolts.end_state", "1", "the same for the plate or the anchor", b.end_state);
    of_node("bolts.bar_state", "1", "0: elastic, 1, 2: yields in tension, compression",
            b.bar_state);
    of_node("bolts.bar_broken", "1", "0: whole, 1: ruptured, 2: cut by digging", b.bar_broken);
    of_node("bolts.grout_lost", "1", "1: its rock was excavated", b.grout_lost);
  }
  static void describe_state(State& b, const auto& stored, const auto& rebuilt) {
    stored({.name = "bolts.phase",
            .meaning = "0: waits, 1: is placed in the next step, 2: acts, 3: removed",
            .rows = Bolts::name},
           b.phase);
    describe_nodes(b, stored);
    const auto of_crossing = [&](const char* name, const char* unit, const char* meaning,
                                 const char* part, Column<Real>& numbers) {
      stored({.name = name,
              .unit = unit,
              .meaning = meaning,
              .rows = "bolt_crossings",
              .numbers = 4,
              .parts = {{part, 3}, ""}},
             numbers);
    };
    of_crossing("bolts.dowel_free", "m, -", "shift at which the dowel is free, and a pad", "shift",
                b.dowel_free);
    of_crossing("bolts.dowel_force", "N, -",
                "its force on the block that the bolt leaves, and a pad", "force", b.dowel_force);
    const auto of_bolt = [&](const char* name, const char* meaning, Column<Real>& numbers) {
      stored({.name = name, .unit = "J", .meaning = meaning, .rows = Bolts::name}, numbers);
    };
    of_bolt("bolts.stored", "elastic energy", b.stored);
    of_bolt("bolts.lost", "work of slip, yield and rupture", b.lost);
    of_bolt("bolts.jacked", "work of the jack that gave it its pretension", b.jacked);
    rebuilt(
        "act_of_modules",
        {.name = "bolts.scratch",
         .unit = "m, m, of the solver, -",
         .meaning = "place of a node x y z, length of its bar, three numbers of the solver, a pad",
         .rows = "bolt_nodes",
         .numbers = 8,
         .parts = {{"place", 3}, "length", {"solver", 3}, ""}},
        b.scratch);
    rebuilt("find_awake",
            {.name = "bolts.awake",
             .meaning = "blocks of bolts that hold rock that can move; all are computed",
             .refers_to = {blocks_of(name)}},
            b.awake);
  }
};

}  // namespace cdem
