// module.hpp - functions of a module for the engine. A module acts on nodes and is not part of
// the method itself.
//
// Elements, bonded pairs and contacts are the method: they know each other. All else is a module,
// a struct with
//
//   static constexpr const char* name;             of its items, and before those of its arrays
//   static constexpr Port port;                    how its forces come to nodes
//   static constexpr Stage stage;                  when in a step it acts
//   struct Given, State;                           its arrays in the model and in the state; each
//                                                  says `using Module =` whose they are
//   static void take_counts(given, number);        how many items: number("name"), 0 if not said
//   static void describe(given, state, visit);     visit.given, visit.stored, visit.rebuilt(array)
//   static void describe_rows(given, visit);       visit(kind, count) of kinds of rows of its own
//   static void act(model, state, queue);          write its rows
//
// Forces between nodes, or nodes and the ground, Port::rows: each node adds the rows of its items,
// and the module books their energy. Given has `count`, and `corner_first`, the first of its rows
// among the corner forces. State has `Column<Index> awake`, blocks of items whose nodes can move,
// which find_awake lists. Its items are a kind of rows with the name of the module.
//
//   static void size(given, state);                room for the state at the start
//   static auto activity(state);                   is_active(item): does it act on its nodes?
//   static auto rows_of(given);                    for_each_row(item, visit): visit(node, row) of
//                                                  its rows, counted from its first
//   static auto stiffness_of(given);               for_each_stiffness(item, visit):
//                                                  visit(node, stiffness at most  [N/m])
//   static void for_each_energy(state, visit);     visit(term, column), see energy_term
//   static void take_out(given, state, items, out);  nodes of these items are out now: their
//                                                  stored energy goes into a term of losses
//   static void bring_in(given, state, out);       blocks have come in
//   static std::vector<NodeSpring> springs(model, state);  if any: its stiffness after `act`, for a
//                                                  solve; they do not hold a body by themselves
//
// Forces from outside, Port::applied: `act` writes a row for each vertex that it loads into
// applied_of<Module>(state).rows. The engine sums them on nodes that are not out, books their work
// by the term with the name of the module, and keeps the forces that an excavation removes, like
// other forces, until they are released.
//
//   static bool is_there(given);                   does the case have it?
//   static std::vector<Index> row_nodes(model, state);  node of each of its rows
//   static std::vector<NodeDashpot> dashpots(given, state);  if any, to the ground: implicit
//   static Real frequency_squared(given, stiffer);  if any: of masses of its own, at most  [1/s2],
//                                                 in rock with so much higher moduli
//   static void start(model, state);               if any: its state at the start
//   static void renew(model, state, comes);        if any: nodes with flag 1 have come in
//   static auto stiffness_of(given);               if any: for_each_stiffness(visit):
//                                                  visit(node, stiffness at most  [N/m])
//
// The rest belongs to the engine: who sums the rows, fused kernel, sleep, stable step, ledger,
// checkpoint. No file outside the folder of a module names it, but modules.hpp, tests, and the
// bindings for changes by a stage.
#pragma once

#include <concepts>
#include <vector>

#include "core/base/column.hpp"
#include "core/base/device.hpp"
#include "core/records/module_ports.hpp"

namespace cdem {

struct Model;
struct State;

/// Forces that a module of Port::applied puts on nodes.
struct AppliedForces {
  Column<Real> rows;         // rows of 4: output of `act`  [N]
  Column<Index> first, row;  // [node + 1], rows that a node sums, see list_applied
  Column<Real> sum;          // row of 4 a node  [N]
  Column<Real> work;         // [node]  [J]
};

/// Arrays of a module.
template <class Data>
concept ModuleData = requires { typename std::remove_const_t<Data>::Module; };

/// Any visitor, for the concepts.
struct AnyVisit {
  template <class... All>
  void operator()(const All&...) const {}
};
/// Any numbers by name, for the concepts.
struct AnyNumber {
  Index operator()(const char*) const { return 0; }
};

template <class M>
concept HasItsData = requires(const typename M::Given& given, typename M::Given& taken,
                              typename M::State& state, const Model& model, State& all) {
  { M::name } -> std::convertible_to<const char*>;
  { M::port } -> std::convertible_to<Port>;
  { M::stage } -> std::convertible_to<Stage>;
  requires std::same_as<typename M::Given::Module, M> && std::same_as<typename M::State::Module, M>;
  M::take_counts(taken, AnyNumber{});
  M::describe(taken, state, AnyVisit{});
  M::describe_rows(given, AnyVisit{});
  M::act(model, all, Queue{});
};
template <class M>
concept PutsRows = requires(const typename M::Given& given, typename M::State& state,
                            const std::vector<Index>& items, const Flag* out) {
  { given.count + given.corner_first } -> std::same_as<Index>;
  { (state.awake) } -> std::same_as<Column<Index>&>;
  M::size(given, state);
  { M::activity(state)(Index(0)) } -> std::convertible_to<bool>;
  M::rows_of(given)(Index(0), AnyVisit{});
  M::for_each_energy(state, AnyVisit{});
  M::take_out(given, state, items, out);
  M::bring_in(given, state, out);
};
template <class M>
concept KnowsItsStiffness =
    requires(const typename M::Given& given) { M::stiffness_of(given)(Index(0), AnyVisit{}); };
template <class M>
concept Applies = requires(const typename M::Given& given, const Model& model, const State& all) {
  { M::is_there(given) } -> std::convertible_to<bool>;
  { M::row_nodes(model, all) } -> std::same_as<std::vector<Index>>;
};

/// The arrays of one module, as a base with a type of its own.
template <class Module>
struct GivenPart {
  typename Module::Given given;
};
template <class Module>
struct StatePart {
  typename Module::State state;
};
template <class Module>
  requires(Module::port == Port::applied)
struct StatePart<Module> {
  typename Module::State state;
  AppliedForces applied;
};

/// Whether a module has all functions of its port. The compiler then names the one that is
/// missing, or that takes other arguments.
template <class M, Port = M::port>
struct Answers {
  static_assert(HasItsData<M>, "a module lacks one of the answers at the top of module.hpp");
  static_assert(PutsRows<M>, "Port::rows lacks one of its answers, see the top of module.hpp");
  static_assert(KnowsItsStiffness<M>, "Port::rows needs stiffness_of: the step is found from it");
  static constexpr bool checked = true;
};
template <class M>
struct Answers<M, Port::applied> {
  static_assert(HasItsData<M>, "a module lacks one of the answers at the top of module.hpp");
  static_assert(Applies<M>, "Port::applied lacks one of its answers, see the top of module.hpp");
  static constexpr bool checked = true;
};

/// Every module once; the data of each, one after the other.
template <class... Modules>
struct ModuleList {
  static_assert((Answers<Modules>::checked && ...));

  template <template <class> class Part>
  struct Data : Part<Modules>... {};

  /// Call visit.operator()<Module>() for each.
  template <class Visit>
  static void for_each(Visit&& visit) {
    (visit.template operator()<Modules>(), ...);
  }
  /// The same for modules of one port.
  template <Port port, class Visit>
  static void for_each_of(Visit&& visit) {
    for_each([&]<class Module>() {
      if constexpr (Module::port == port) visit.template operator()<Module>();
    });
  }
};

/// Data of a module in a model, and in a state.
template <class Module, class M>
auto& given_of(M& model) {
  auto& part = model.modules;
  if constexpr (std::is_const_v<M>)
    return static_cast<const GivenPart<Module>&>(part).given;
  else
    return static_cast<GivenPart<Module>&>(part).given;
}
template <class Module, class S>
auto& part_of(S& state) {
  auto& part = state.modules;
  if constexpr (std::is_const_v<S>)
    return static_cast<const StatePart<Module>&>(part);
  else
    return static_cast<StatePart<Module>&>(part);
}
template <class Module, class S>
auto& state_of(S& state) {
  return part_of<Module>(state).state;
}
/// Forces of a module of Port::applied on nodes.
template <class Module, class S>
auto& applied_of(S& state) {
  return part_of<Module>(state).applied;
}

}  // namespace cdem
