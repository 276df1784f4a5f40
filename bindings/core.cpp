// core.cpp - names and shapes for Python, and nothing else.
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings/arrays.hpp"
#include "bindings/laws.hpp"
#include "bindings/ranks.hpp"
#include "bindings/solve.hpp"
#include "core/base/device.hpp"
#include "core/base/emulated.hpp"
#include "core/base/machine_limits.hpp"
#include "core/base/openmp.hpp"
#include "core/bonds/initial_tractions.hpp"
#include "core/contact/broad_phase/predicted_motion.hpp"
#include "core/contact/pair_list/deep_overlaps.hpp"
#include "core/contact/pair_list/initial_overlaps.hpp"
#include "core/diagnostics/energy.hpp"
#include "core/diagnostics/fast_weakening.hpp"
#include "core/diagnostics/unbalance.hpp"
#include "core/elements/change_damping.hpp"
#include "core/elements/report.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/init_state.hpp"
#include "core/nodes/applied.hpp"
#include "core/nodes/curves.hpp"
#include "core/nodes/ground.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/nodes.hpp"
#include "core/nodes/time_step.hpp"
#include "core/rest/rest.hpp"
#include "core/run/bring_in.hpp"
#include "core/run/change_items.hpp"
#include "core/run/excavate.hpp"
#include "core/run/run.hpp"
#include "core/run/take_out.hpp"

using namespace nb::literals;

namespace cdem {

namespace {

void take_counts(Core& core, const nb::dict& c) {
  const auto number = [&](const char* name) { return nb::cast<Index>(c[name]); };
  Model& m = core.model;
  m.node_count = number("nodes");
  m.face_count = number("faces");
  m.edge_count = number("edges");
  m.class_count = number("interface_classes");
  m.corner_rows = number("corner_rows");
  const auto take = [&](const auto& kind, auto& set, const auto&) {
    const std::string name = kind.name;
    set.count = number((name + ".count").c_str());
    set.stride = padded_stride(set.count);
    set.corners = kind.corners, set.points = kind.points;
    set.corner_first = number((name + ".corner_first").c_str());
  };
  for_each_element_set(m, core.state, take);
  for_each_pair_set(m, core.state, take);
  const auto if_said = [&](const char* name) { return c.contains(name) ? number(name) : 0; };
  Modules::for_each([&]<class Module>() { Module::take_counts(given_of<Module>(m), if_said); });
  for_each_pair_set(m, core.state, [&](const auto& kind, PairSet& p, const PairState&) {
    const std::string points = std::string(kind.name) + ".points";  // of ragged point tables
    p.point_stride = c.contains(points.c_str()) ? padded_stride(number(points.c_str())) : p.stride;
  });
}

Formulation formulation(const std::string& name) {
  if (name == "corotational") return Formulation::corotational;
  if (name == "incremental") return Formulation::incremental;
  if (name == "paper-incremental") return Formulation::paper_incremental;
  if (name == "paper-total") return Formulation::paper_total;
  throw nb::value_error("unknown element formulation");
}

void set_options(Core& core, const nb::dict& o) {
  const auto real = [&](const char* name) { return nb::cast<Real>(o[name]); };
  Model& m = core.model;
  m.formulation = formulation(nb::cast<std::string>(o["formulation"]));
  m.rules.indentation = real("indentation");
  m.rules.action = real("action");
  m.rules.tolerance = real("tolerance");
  m.bond_indentation_triangle = real("bond_indentation_triangle");
  m.bond_indentation_quad = real("bond_indentation_quad");
  m.semi_edges = nb::cast<bool>(o["semi_edges"]);
  m.initial_stress = nb::cast<bool>(o["initial_stress"]);
  m.loose_pairs = nb::cast<bool>(o["loose_pairs"]);
  m.lumped_while_bonded = nb::cast<bool>(o["lumped_while_bonded"]);
  m.check_search = nb::cast<bool>(o["check_search"]);
  m.rebuild_interval = nb::cast<Index>(o["rebuild_interval"]);
  m.step_safety = real("step_safety");
  m.step_given = real("step_given");
  m.speed_limit = real("speed_limit");
  const auto g = nb::cast<std::vector<Real>>(o["gravity"]);
  m.gravity = {g.at(0), g.at(1), g.at(2)};
}

Relaxation relaxation(const std::string& name) {
  if (name == "none") return Relaxation::none;
  if (name == "kinetic") return Relaxation::kinetic;
  if (name == "adaptive") return Relaxation::adaptive;
  throw nb::value_error("unknown relaxation");
}

const char* name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::steps_done:
      return "steps_done";
    case Outcome::time_reached:
      return "time_reached";
    case Outcome::converged:
      return "converged";
    case Outcome::not_finite:
      return "not_finite";
    case Outcome::too_fast:
      return "too_fast";
    case Outcome::lost_contact:
      return "lost_contact";
    case Outcome::missed_contact:
      return "missed_contact";
    case Outcome::ghosts_due:
      return "ghosts_due";
  }
  return "";
}

/// A term that is always zero is not listed.
bool is_told(const EnergyTerm& term) { return any_law_flows || !term.needs_flow; }

nb::typed<nb::dict, nb::str, double> energy_ledger(const Core& core) {
  const Energies e = energies(core.model, core.state);
  nb::typed<nb::dict, nb::str, double> ledger;
  for (std::size_t k = 0; k < energy_term_count; ++k)
    if (is_told(energy_terms[k])) ledger[energy_terms[k].name] = e.terms[k];
  ledger["start"] = e.start, ledger["error"] = e.error;
  return ledger;
}

Dicts energy_term_infos() {
  static constexpr const char* kinds[] = {"stored", "lost", "supplied", "hidden"};
  Dicts infos;
  for (const EnergyTerm& term : energy_terms) {
    if (!is_told(term)) continue;
    nb::dict one;
    one["name"] = term.name, one["kind"] = kinds[int(term.kind)], one["meaning"] = term.meaning;
    infos.append(one);
  }
  return infos;
}

void set_curves(Core& c, const std::vector<std::vector<Real>>& times,
                const std::vector<std::vector<Real>>& factors) {
  c.model.curve_time = times;
  c.model.curve_factor = factors;
  find_loads_and_supports(c.model, c.state);
}

void set_gravity(Core& c, const std::vector<Real>& g) {
  c.model.gravity = {g.at(0), g.at(1), g.at(2)};
}

void set_damping(Core& c, Real local, Real mass, Real stiffness, Real contact) {
  c.model.damping = {local, mass};
  c.model.stiffness_damping = stiffness;
  c.model.contact_damping = contact;
}

MaxwellBranches branches(const std::vector<Real>& weights, const std::vector<Real>& rates) {
  MaxwellBranches all;
  if (weights.size() != rates.size() || weights.size() > std::size(all.weight))
    throw nb::value_error("a weight and a rate for each branch");
  std::copy(weights.begin(), weights.end(), all.weight);
  std::copy(rates.begin(), rates.end(), all.rate);
  return all;
}

/// Remove whole blocks, given by a flag for each node; excavated blocks keep their forces on the
/// rest until they are released.
template <auto leave>
void take_nodes(Core& c, Array<Flag> leaves) {
  if (leaves.ndim() != 1 || leaves.shape(0) != std::size_t(c.model.node_count))
    throw nb::value_error("one flag for each node");
  leave(c.model, c.state, leaves.data());
}

/// Bring whole blocks in, given by a flag for each node, with arrays of the model that go with it.
void bring_nodes_in(Core& c, Array<Flag> comes, Array<Real> position, const Views& arrays,
                    Array<Flag> bonded) {
  if (comes.ndim() != 1 || comes.shape(0) != std::size_t(c.model.node_count))
    throw nb::value_error("one flag for each node");
  place_nodes(c.state, comes.data(), position.data());
  update_model(c, arrays);
  bring_in(c.model, c.state, comes.data(), bonded.data());
}

/// Let a stage change the items of a module, given by a flag for each.
template <class Module, auto change>
void take_items(Core& c, Array<Flag> which) {
  if (which.ndim() != 1 || which.shape(0) != std::size_t(given_of<Module>(c.model).count))
    throw nb::value_error("one flag for each item");
  change_items<Module, change>(c.model, c.state, which.data());
}

auto run_core(Core& c, std::int64_t steps, Real end_time, Real unbalance_limit,
              std::int64_t check_interval, const std::string& way) {
  const Goal goal{.steps = steps,
                  .end_time = end_time,
                  .unbalance_limit = unbalance_limit,
                  .check_interval = check_interval,
                  .relaxation = relaxation(way)};
  Report r;
  {
    nb::gil_scoped_release release;
    r = run(c.model, c.state, goal);
  }
  return std::make_tuple(std::string(name_of(r.outcome)), r.culprit, r.value);
}

/// Mean stress of all elements by shape.
Views stress(nb::handle_t<Core> self) {
  Core& c = nb::cast<Core&>(self);
  report_stress(c.model, c.state);
  Views tables;
  for_each_element_set(c.model, c.state,
                       [&](const auto& kind, const ElementSet&, ElementState& es) {
                         tables[kind.name] = view(es.stress, self);
                       });
  return tables;
}

/// Plastic flow of all elements by shape; empty for elastic materials.
Views yielded(nb::handle_t<Core> self) {
  Core& c = nb::cast<Core&>(self);
  report_stress(c.model, c.state);
  Views tables;
  for_each_element_set(c.model, c.state,
                       [&](const auto& kind, const ElementSet&, ElementState& es) {
                         tables[kind.name] = view(es.yielded, self);
                       });
  return tables;
}

/// Bond points broken so far, in tension and in shear.
auto broken_points(Core& c) {
  Real tension = 0, shear = 0;
  for_each_pair_set(c.model, c.state, [&](const auto&, const PairSet& p, PairState& s) {
    const auto in_tension = on_host(s.broken_tension), in_shear = on_host(s.broken_shear);
    for (Index pair = 0; pair < p.count; ++pair)
      tension += in_tension[pair], shear += in_shear[pair];
  });
  return std::make_tuple(std::int64_t(tension), std::int64_t(shear));
}

/// Position and both faces of every bond point.
auto bond_place_arrays(Core& c) {
  std::vector<Real> position;
  std::vector<Index> faces;
  for (const BondPlace& place : bond_places(c.model, c.state)) {
    for (const Real x : {place.position.x, place.position.y, place.position.z})
      position.push_back(x);
    faces.insert(faces.end(), place.faces, place.faces + 2);
  }
  return std::make_tuple(array_of(std::move(position)), array_of(std::move(faces)));
}

/// Stress of every bond point, and whether an interface has strength.
auto set_tractions(Core& c, Array<Real> stress, Array<Flag> bonded) {
  const CutTractions cut = set_initial_tractions(c.model, c.state, stress.data(), bonded.data());
  return std::make_tuple(cut.count, cut.most, cut.face);
}

/// Input and settings before a run.
void bind_setup(nb::class_<Core>& core) {
  core.def("take_counts", &take_counts, "counts"_a)
      .def("take_model", &take_model, "arrays"_a)
      .def("update_model", &update_model, "arrays"_a)
      .def("set_options", &set_options, "options"_a)
      .def("set_interfaces", &set_interfaces, "interfaces"_a)
      .def("set_curves", &set_curves)
      .def("set_gravity", &set_gravity)
      .def("set_damping", &set_damping)
      .def(
          "set_rock_damping",
          [](Core& c, Real time, const std::vector<Real>& weights, const std::vector<Real>& rates) {
            c.model.damping_time = time;
            c.model.maxwell = branches(weights, rates);
          },
          "time"_a, "weights"_a, "rates"_a)
      .def("set_lumped", [](Core& c, bool lumped) { c.model.lumped = lumped; })
      .def("take_settings", &take_settings, "whole"_a)
      .def("take_share", &take_share, "exchange"_a, "share"_a)
      .def("start",
           [](Core& c, Array<Real> position) { init_state(c.model, c.state, position.data()); })
      .def("bond_places", &bond_place_arrays)
      .def("find_applied", [](Core& c) { change_applied(c.model, c.state); })
      .def("set_initial_tractions", &set_tractions, "stress"_a, "bonded"_a)
      .def("restore", &restore)
      .def("restore_anew", &restore_anew)
      .def("drop_state", &drop_state)
      .def("prepare",
           [](Core& c) {
             hold_taken_out(c.model, c.state);
             prepare(c.model, c.state);
           })
      .def("adopt_overlaps", [](Core& c) {
        InitialOverlaps found = adopt_overlaps(c.model, c.state);
        const DeepOverlaps deep = find_deep_overlaps(c.model, c.state, found);
        const Vec3<Real>& at = deep.place;
        return std::make_tuple(std::make_tuple(found.deepest, found.count, found.face),
                               std::make_tuple(deep.count, deep.block[0], deep.block[1], deep.depth,
                                               deep.allowed, std::make_tuple(at.x, at.y, at.z)));
      });
}

/// The loop, and changes between two runs of it.
void bind_run(nb::class_<Core>& core) {
  core.def("run", &run_core, "steps"_a, "end_time"_a = 1e300, "unbalance_limit"_a = 0.0,
           "check_interval"_a = 20, "relaxation"_a = "none")
      .def(
          "solve_for_rest",
          [](Core& c, Real limit, int most_iterations) {
            const RestFound found = solve_for_rest(c.model, c.state, limit, most_iterations);
            return std::make_tuple(found.rounds, found.iterations, found.before, found.after);
          },
          "unbalance_limit"_a, "most_iterations"_a = 200)
      .def("take_out", &take_nodes<take_out>, "leaves"_a)
      .def("excavate", &take_nodes<excavate>, "leaves"_a)
      .def("bring_in", &bring_nodes_in, "comes"_a, "position"_a, "arrays"_a, "bonded"_a)
      .def(
          "begin_surfaces",
          [](Core& c, Array<Flag> which) {
            if (which.ndim() != 1 ||
                which.shape(0) != std::size_t(given_of<Surface>(c.model).count))
              throw nb::value_error("one flag for each entry");
            Surface::begin(c.model, c.state, which.data());
            list_ground(c.model, c.state);
            list_lumped(c.model, c.state);
            list_awake_nodes(c.model, c.state);
            renew_step(c.model, c.state);
          },
          "which"_a)
      .def("install_bolts", &take_items<Bolts, Bolts::install>, "which"_a)
      .def("remove_bolts", &take_items<Bolts, Bolts::remove>, "which"_a)
      .def(
          "release_forces",
          [](Core& c, Real part, Real end) { release_forces(c.state, part, end); }, "part"_a,
          "end_time"_a)
      .def("begin_peaks", [](Core& c) { begin_peaks(c.model, c.state); })
      .def(
          "keep_peaks", [](Core& c, bool keep) { c.state.nodes.keeps_peaks = keep; }, "keep"_a)
      .def("leave_adaptive",
           [](Core& c) {  // the next step stops all motion, if it is one of kinetic relaxation
             close_ledger(c.model, c.state);
             change_mass(c.model, c.state, c.model.lumped);
             renew_step(c.model, c.state);
             c.state.stop_due = true;
           })
      .def("renew_step", [](Core& c) { renew_step(c.model, c.state); })
      .def("change_mass", [](Core& c, bool lumped) { change_mass(c.model, c.state, lumped); })
      .def(
          "change_rock_damping",
          [](Core& c, Real time, const std::vector<Real>& weights, const std::vector<Real>& rates) {
            change_damping(c.model, c.state, branches(weights, rates), time);
          },
          "time"_a, "weights"_a, "rates"_a)
      .def(
          "change_moduli", [](Core& c, Real part) { change_moduli(c.model, c.state, part); },
          "part"_a)
      .def("move_exact_masses",
           [](Core& c) {  // as if no block had bonds any more
             c.model.lumped_while_bonded = false;
             list_lumped(c.model, c.state);
             renew_step(c.model, c.state);
           })
      .def("keep_energy_scale", [](Core& c) { keep_energy_scale(c.model, c.state); });
}

/// Views of arrays, and their contents.
void bind_views(nb::class_<Core>& core) {
  core.def("model", &model_arrays)
      .def("fields", &stored_arrays)
      .def("absent_fields", &absent_fields,
           "Names of stored arrays of modules that the case does not have.")
      .def("rebuilt", &rebuilt_arrays)
      .def("array", &array_by_name, "name"_a)
      .def("scalars", &scalars)
      .def("describe", &describe_arrays)
      .def("describe_rows", &describe_row_kinds)
      .def("describe_scalars", &scalar_infos)
      .def("yielded", &yielded, "Present and past plastic flow of each element, by shape.")
      .def("stress", &stress);
}

/// Values computed from the state.
void bind_diagnostics(nb::class_<Core>& core) {
  core.def("energies", &energy_ledger)
      .def("broken", &broken_points, "Bond points broken so far, in tension and in shear.")
      .def("seconds",
           [](const Core& c) {
             const Real* t = c.state.seconds;
             return std::make_tuple(t[0], t[1], t[2], t[3], t[4]);
           })
      .def(
          "fast_weakenings",
          [](Core& c) {
            nb::list found;
            for (const FastWeakening& w : fast_weakenings(c.model, c.state))
              found.append(nb::make_tuple(w.interface, w.ratio, w.place.x, w.place.y, w.place.z));
            return found;
          },
          "Interface, ratio and place of contacts whose friction falls with the speed.")
      .def("unbalance_ratio", [](const Core& c) { return unbalance_ratio(c.model, c.state); })
      .def(
          "coming_paths",
          [](const Core& c, Array<Real> length) {
            Column<Real> of_nodes;
            of_nodes.assign(length.data(), length.size());
            return array_of(fetch(coming_paths(c.model, c.state, of_nodes)));
          },
          "length"_a,
          "Velocities of the next prediction and skins at most of nodes, for faces up to these L.")
      .def(
          "rebuild_interval", [](const Core& c) { return c.model.rebuild_interval; },
          "Steps from one rebuild of the pair list to the next; 0: as it is needed.")
      .def(
          "asks_area", [](const Core& c) { return c.model.interface_traits.ask_area; },
          "Whether a law of the interfaces asks for areas of contacts.")
      .def(
          "lift", [](const Core& c) { return c.model.rules.lifted; },
          "Gap up to which contacts that have dilated are kept, at most [m].")
      .def(
          "stable_step",
          [](Core& c, const std::vector<Real>& damping, Real time, const std::vector<Real>& weights,
             const std::vector<Real>& rates, bool lumped) {
            return stable_step(c.model, c.state,
                               {.nodes = {damping.at(0), damping.at(1)},
                                .stiffness = damping.at(2),
                                .contact = damping.at(3),
                                .time = time,
                                .maxwell = branches(weights, rates),
                                .lumped = lumped});
          },
          "damping"_a, "time"_a, "weights"_a, "rates"_a, "lumped"_a,
          "Stable step with the damping of a stage: local, mass, stiffness, contact; then of rock.")
      .def("step_limit", [](const Core& c) {
        const StepLimit l = step_limit(c.model, c.state);
        return std::make_tuple(l.dt, l.node, l.element_frequency_squared,
                               l.contact_frequency_squared, l.bond_part);
      });
}

#if defined(CDEM_EMULATED)
/// Counts of the emulated device.
void bind_emulated(nb::module_& module) {
  module.def("forget", &forget);
  module.def("seen", [] {
    const Seen all = seen();
    nb::list host;
    for (const HostAccess& one : all.host)
      host.append(std::make_tuple(one.place, one.reads, one.writes));
    nb::dict told;
    told["launches"] = all.launches, told["waits"] = all.waits;
    told["transfers"] = all.transfers, told["host"] = host;
    return told;
  });
}
#endif

}  // namespace
}  // namespace cdem

NB_MODULE(CDEM_MODULE, module) {
  using namespace cdem;
  module.attr("lanes") = lanes;
  module.def("padded_stride", &padded_stride, "count"_a);
  module.def("weibull_factors", &weibull_factors, "faces"_a, "seed"_a, "shape"_a, "mean"_a);
  module.def("interface_laws", &declarations<InterfaceLaws>, "Declarations of the interface laws.");
  module.def("block_laws", &declarations<BlockLaws>, "Declarations of the block laws.");
  module.def("surface_laws", &declarations<SurfaceLaws>, "Declarations of the surface laws.");
  module.def("surface_contradiction", &contradiction<SurfaceLaws>, "law"_a, "parameters"_a);
  module.def("surface_numbers", &surface_numbers, "law"_a, "parameters"_a);
  module.def("interface_contradiction", &contradiction<InterfaceLaws>, "law"_a, "parameters"_a);
  module.def("interface_curve_end", &curve_end, "law"_a, "parameters"_a, "stiffness_n"_a);
  module.def("interface_steepest_fall", &steepest_fall, "law"_a, "parameters"_a);
  module.def("block_contradiction", &contradiction<BlockLaws>, "law"_a, "parameters"_a);
  module.def("material_numbers", &material_numbers, "law"_a, "parameters"_a, "softening"_a);
  module.attr("fall_pieces") = fall_pieces;
  module.attr("interface_law_state") = InterfaceLaws::most_state;
  module.attr("point_history") = point_history;
  module.attr("widest_skin") = widest_skin;
  module.def("device_name", &device_name);
  module.def("energy_terms", &energy_term_infos,
             "Terms of the energy ledger: name, kind (stored, lost, supplied) and meaning.");
  module.def("near_boxes", &near_boxes, "boxes"_a, "reach"_a, "flags"_a,
             "Flags of the boxes near one with a flag: no farther than twice the smaller reach.");
  module.def("solve_blocks", &solve_blocks, "system"_a, "right"_a, "part"_a, "most_iterations"_a);
  module.def("set_threads", [](int count) { omp_set_num_threads(count); }, "count"_a);
  module.def("measure_bandwidth", &measure_bandwidth, "bytes"_a,
             "Memory bandwidth of a triad over arrays of so many bytes together [B/s].");
  module.def("measure_flops", &measure_flops, "Peak rate of fused multiply-adds [flop/s].");
  module.def("max_threads", [] { return omp_get_max_threads(); });
  module.attr("openmp") = with_openmp;

  nb::class_<Core> core(module, "Core");
  core.def(nb::init<>());
  bind_setup(core);
  bind_run(core);
  bind_views(core);
  bind_diagnostics(core);
#if defined(CDEM_EMULATED)
  bind_emulated(module);
#endif
}
