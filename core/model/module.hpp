// module.hpp - what the engine asks of a thing that acts on nodes and is no part of the method
// itself.
//
// Elements, bonded pairs and contacts are the method: they know each other. All else is a module,
// a struct with
//
//   static constexpr const char* name;             of its items, and before those of its arrays
//   struct Given, State;                           its arrays in the model and in the state; each
//                                                  says `using Module =` whose they are
//   static void describe(given, state, visit);     visit.given, visit.stored, visit.rebuilt(array)
//   static void describe_rows(given, visit);       visit(kind, count) of kinds of rows of its own
//   static void size(given, state);                room for the state at the start
//   static auto activity(state);                   is_active(item): does it act on its nodes?
//   static auto rows_of(given);                    for_each_row(item, visit): visit(node, row) of
//                                                  its rows, counted from its first
//   static auto stiffness_of(given);               for_each_stiffness(item, visit):
//                                                  visit(node, stiffness at most  [N/m])
//   static void for_each_energy(state, visit);     visit(term, column), see energy_term
//   static void act(model, state, queue);          write its rows, before contacts act
//   static void take_out(given, state, items, out);  nodes of these items are out now
//   static void bring_in(given, state, out);         blocks have come in
//
// Given has `count`, `stride`, and `corner_first`, the first of its rows among the corner forces.
// What follows from the rows is the engine's: who sums them, fused kernel, sleep, stable step,
// ledger, checkpoint. No file outside the folder of a module names it, but modules.hpp, tests, and
// the bindings of what a stage does to it.
#pragma once

#include <concepts>

#include "core/base/device.hpp"
#include "core/model/column_info.hpp"

namespace cdem {

struct Model;
struct State;

/// Arrays of a module.
template <class Data>
concept ModuleData = requires { typename std::remove_const_t<Data>::Module; };

/// Any visitor, for the concepts.
struct AnyVisit {
  template <class... All>
  void operator()(const All&...) const {}
};

template <class M>
concept HasItsData = requires(const typename M::Given& given, typename M::State& state) {
  { M::name } -> std::convertible_to<const char*>;
  { given.count + given.stride + given.corner_first } -> std::same_as<Index>;
  requires std::same_as<typename M::Given::Module, M> && std::same_as<typename M::State::Module, M>;
  M::size(given, state);
  M::describe_rows(given, AnyVisit{});
};
template <class M>
concept PutsRows = requires(const typename M::Given& given, const typename M::State& state,
                            const Model& model, State& all) {
  { M::activity(state)(Index(0)) } -> std::convertible_to<bool>;
  M::rows_of(given)(Index(0), AnyVisit{});
  M::for_each_energy(state, AnyVisit{});
  M::act(model, all, Queue{});
};
template <class M>
concept KnowsItsStiffness =
    requires(const typename M::Given& given) { M::stiffness_of(given)(Index(0), AnyVisit{}); };

/// The arrays of one module, as a base with a type of its own.
template <class Module>
struct GivenPart {
  typename Module::Given given;
};
template <class Module>
struct StatePart {
  typename Module::State state;
};

/// Every module once; the data of each, one after the other.
template <class... Modules>
struct ModuleList {
  static_assert((HasItsData<Modules> && ...), "a module needs its name, its data, and their size");
  static_assert((PutsRows<Modules> && ...),
                "a module says who acts, on which nodes, at which cost");
  static_assert((KnowsItsStiffness<Modules> && ...),
                "forces between nodes need stiffness_of: the step is found from it");

  template <template <class> class Part>
  struct Data : Part<Modules>... {};

  /// Call visit.operator()<Module>() for each.
  template <class Visit>
  static void for_each(Visit&& visit) {
    (visit.template operator()<Modules>(), ...);
  }
};

/// What a module has in a model, and in a state.
template <class Module, class M>
auto& given_of(M& model) {
  auto& part = model.modules;
  if constexpr (std::is_const_v<M>)
    return static_cast<const GivenPart<Module>&>(part).given;
  else
    return static_cast<GivenPart<Module>&>(part).given;
}
template <class Module, class S>
auto& state_of(S& state) {
  auto& part = state.modules;
  if constexpr (std::is_const_v<S>)
    return static_cast<const StatePart<Module>&>(part).state;
  else
    return static_cast<StatePart<Module>&>(part).state;
}

}  // namespace cdem
