// core.cpp - names and shapes for Python, and nothing else.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/device.hpp"
#include "core/base/machine_limits.hpp"
#include "core/contact/pair_list/initial_overlaps.hpp"
#include "core/diagnostics/energy.hpp"
#include "core/diagnostics/unbalance.hpp"
#include "core/elements/report.hpp"
#include "core/interfaces/laws.hpp"
#include "core/materials/laws.hpp"
#include "core/model/describe.hpp"
#include "core/model/describe_scalars.hpp"
#include "core/model/force_sets.hpp"
#include "core/model/init_state.hpp"
#include "core/nodes/curves.hpp"
#include "core/nodes/masses.hpp"
#include "core/nodes/time_step.hpp"
#include "core/run/run.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace cdem {

/// A model and its state: what one simulation holds.
struct Core {
  Model model;
  State state;
};

namespace {

template <class T>
using Array = nb::ndarray<const T, nb::c_contig, nb::device::cpu>;

template <class T>
nb::object view(Column<T>& column, nb::handle owner) {
  const std::size_t shape[1] = {column.size()};
  return nb::cast(nb::ndarray<nb::numpy, T>(column.data(), 1, shape, owner));
}

/// Copy every array of the model from a dict of flat arrays; a missing one is our own mistake.
void take_model(Core& core, const nb::dict& arrays) {
  describe(core.model, [&]<class T>(const std::string& name, Column<T>& column) {
    const auto array = nb::cast<Array<T>>(arrays[name.c_str()]);
    column.assign(array.data(), array.size());
  });
  for_each_element_set(core.model, core.state,
                       [](const auto& kind, ElementSet& e, const ElementState&) {
                         e.points = kind.points;  // one where there are hourglass springs
                       });
}

/// Views of the model's arrays; only until one of them is changed.
nb::object model_arrays(nb::handle_t<Core> self) {
  nb::dict arrays;
  describe(nb::cast<Core&>(self).model, [&]<class T>(const std::string& name, Column<T>& column) {
    arrays[name.c_str()] = view(column, self);
  });
  return arrays;
}

/// Copy those arrays of the model that the dict holds: what a stage may change.
void update_model(Core& core, const nb::dict& arrays) {
  describe(core.model, [&]<class T>(const std::string& name, Column<T>& column) {
    if (!arrays.contains(name.c_str())) return;
    const auto array = nb::cast<Array<T>>(arrays[name.c_str()]);
    column.assign(array.data(), array.size());
  });
}

void take_counts(Core& core, const nb::dict& c) {
  const auto number = [&](const char* name) { return nb::cast<Index>(c[name]); };
  Model& m = core.model;
  m.node_count = number("nodes");
  m.face_count = number("faces");
  m.edge_count = number("edges");
  m.class_count = number("interface_classes");
  m.corner_rows = number("corner_rows");
  for_each_set(m, core.state, [&](const auto& kind, auto& set, const auto&) {
    const std::string name = kind.name;
    set.count = number((name + ".count").c_str());
    set.stride = padded_stride(set.count);
    set.corners = kind.corners;
    set.points = kind.points;
    set.corner_first = number((name + ".corner_first").c_str());
  });
  for_each_pair_set(m, core.state, [&](const auto& kind, PairSet& p, const PairState&) {
    const std::string points = std::string(kind.name) + ".points";  // of ragged point tables
    p.point_stride = c.contains(points.c_str()) ? padded_stride(number(points.c_str())) : p.stride;
  });
}

nb::object state_fields(nb::handle_t<Core> self) {
  Core& core = nb::cast<Core&>(self);
  nb::dict fields;
  describe(core.state, [&]<class T>(const std::string& name, Column<T>& column, const char*) {
    fields[name.c_str()] = view(column, self);
  });
  return fields;
}

/// Bring back every array and scalar of a checkpoint.
void restore(Core& core, const nb::dict& arrays, const nb::dict& scalars) {
  describe(core.state, [&]<class T>(const std::string& name, Column<T>& column, const char*) {
    const auto array = nb::cast<Array<T>>(arrays[name.c_str()]);
    column.assign(array.data(), array.size());
  });
  describe_scalars(core.state, [&]<class T>(const ScalarInfo& info, T& number) {
    number = nb::cast<T>(scalars[info.name]);
  });
}

nb::dict scalars(Core& core) {
  nb::dict numbers;
  describe_scalars(
      core.state, [&](const ScalarInfo& info, const auto& number) { numbers[info.name] = number; });
  return numbers;
}

nb::list scalar_infos(Core& core) {
  nb::list infos;
  describe_scalars(core.state, [&](const ScalarInfo& info, const auto&) {
    nb::dict one;
    one["name"] = info.name, one["unit"] = info.unit, one["meaning"] = info.meaning;
    infos.append(one);
  });
  return infos;
}

/// Numbers of a law's parameters in the order of its declaration, from a dict by name.
template <class Law>
std::vector<Real> parameters_of(const nb::dict& values) {
  std::vector<Real> row;
  for (const Parameter& p : Law::parameters) row.push_back(nb::cast<Real>(values[p.name]));
  return row;
}

/// Call act.template operator()<Law, number>() for the law of this name.
template <class Laws, class Act>
void with_law(const std::string& name, const Act& act) {
  bool found = false;
  Laws::for_each([&]<template <class> class Law, Index number>() {
    if (name != Law<Real>::text.name) return;
    found = true;
    act.template operator()<Law, number>();
  });
  if (!found) throw nb::value_error("unknown law");
}

/// Why parameters of a law, as the core takes them, contradict each other, or an empty text.
template <class Laws>
std::string contradiction(const std::string& law, const nb::dict& values) {
  std::string why;
  with_law<Laws>(law, [&]<template <class> class Law, Index>() {
    const char* text = Law<Real>::contradiction(parameters_of<Law<Real>>(values).data());
    if (text) why = text;
  });
  return why;
}

/// What the laws of a list say of themselves.
template <class Laws>
nb::list declarations() {
  nb::list laws;
  Laws::for_each([&]<template <class> class Law, Index>() {
    nb::dict law;
    law["name"] = Law<Real>::text.name;
    law["meaning"] = Law<Real>::text.meaning;
    law["flows"] = false;
    if constexpr (requires { Law<Real>::inelastic; }) law["flows"] = Law<Real>::inelastic;
    nb::list parameters, state;
    for (const Parameter& p : Law<Real>::parameters) {
      nb::dict d;
      d["name"] = p.name, d["symbol"] = p.symbol;
      d["unit"] = p.unit, d["meaning"] = p.meaning;
      d["at_least"] = p.at_least;
      d["below"] = std::isfinite(p.below) ? nb::cast(p.below) : nb::none();
      d["default"] = std::isnan(p.otherwise) ? nb::none() : nb::cast(p.otherwise);
      d["is_tangent"] = p.form == Form::tangent;
      d["is_strength"] = p.is_strength;
      d["bonds"] = p.bonds;
      parameters.append(d);
    }
    for (const StateVariable& v : Law<Real>::state) {
      nb::dict d;
      d["name"] = v.name, d["unit"] = v.unit, d["meaning"] = v.meaning;
      state.append(d);
    }
    law["parameters"] = parameters;
    law["state"] = state;
    laws.append(law);
  });
  return laws;
}

/// The interfaces of the model: law, stiffness_n and stiffness_s as (value, factor), parameters.
void set_interfaces(Core& core, const nb::list& interfaces) {
  Model& m = core.model;
  constexpr std::size_t width = InterfaceLaws::most_parameters;
  m.interfaces.resize(interfaces.size());
  m.interface_parameters.resize(width * interfaces.size());
  m.rules.lifted = 0;
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const auto entry = nb::cast<nb::dict>(interfaces[i]);
    const auto stiffness = [&](const char* name) {
      return nb::cast<std::tuple<Real, Real>>(entry[name]);
    };
    Interface& interface = m.interfaces[i];
    std::tie(interface.stiffness_n_value, interface.stiffness_n_factor) = stiffness("stiffness_n");
    std::tie(interface.stiffness_s_value, interface.stiffness_s_factor) = stiffness("stiffness_s");
    const auto name = nb::cast<std::string>(entry["law"]);
    with_law<InterfaceLaws>(name, [&]<template <class> class Law, Index number>() {
      interface.law = number;
      const auto row = parameters_of<Law<Real>>(nb::cast<nb::dict>(entry["parameters"]));
      std::copy(row.begin(), row.end(), m.interface_parameters.data() + width * i);
      m.rules.lifted = std::max(m.rules.lifted, 2 * Law<Real>::rise_most(row.data()));
    });
  }
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
  }
  return "";
}

/// A term that is zero whatever happens is not told of.
bool is_told(const EnergyTerm& term) { return any_law_flows || !term.needs_flow; }

nb::dict energy_ledger(const Core& core) {
  const Energies e = energies(core.model, core.state);
  nb::dict ledger;
  for (std::size_t k = 0; k < energy_term_count; ++k)
    if (is_told(energy_terms[k])) ledger[energy_terms[k].name] = e.terms[k];
  ledger["start"] = e.start, ledger["error"] = e.error;
  return ledger;
}

nb::list energy_term_infos() {
  static constexpr const char* kinds[] = {"stored", "lost", "supplied"};
  nb::list infos;
  for (const EnergyTerm& term : energy_terms) {
    if (!is_told(term)) continue;
    nb::dict one;
    one["name"] = term.name, one["kind"] = kinds[int(term.kind)], one["meaning"] = term.meaning;
    infos.append(one);
  }
  return infos;
}

}  // namespace
}  // namespace cdem

NB_MODULE(CDEM_MODULE, module) {
  using namespace cdem;
  module.attr("lanes") = lanes;
  module.def("padded_stride", &padded_stride, "count"_a);
  module.def("interface_laws", &declarations<InterfaceLaws>,
             "What the interface laws say of themselves.");
  module.def("block_laws", &declarations<BlockLaws>, "What the block laws say of themselves.");
  module.def("interface_contradiction", &contradiction<InterfaceLaws>, "law"_a, "parameters"_a);
  module.def("block_contradiction", &contradiction<BlockLaws>, "law"_a, "parameters"_a);
  module.attr("block_law_parameters") = BlockLaws::most_parameters;
  module.attr("interface_law_state") = InterfaceLaws::most_state;
  module.attr("point_history") = point_history;
  module.def("device_name", &device_name);
  module.def("energy_terms", &energy_term_infos,
             "Terms of the energy ledger: name, kind (stored, lost, supplied) and meaning.");
  module.def("set_threads", [](int count) { omp_set_num_threads(count); }, "count"_a);
  module.def("measure_bandwidth", &measure_bandwidth, "bytes"_a,
             "Memory bandwidth of a triad over arrays of so many bytes together [B/s].");
  module.def("measure_flops", &measure_flops, "Peak rate of fused multiply-adds [flop/s].");
  module.def("max_threads", [] { return omp_get_max_threads(); });

  nb::class_<Core>(module, "Core")
      .def(nb::init<>())
      .def("take_counts", &take_counts, "counts"_a)
      .def("take_model", &take_model, "arrays"_a)
      .def("update_model", &update_model, "arrays"_a)
      .def("model", &model_arrays)
      .def("set_options", &set_options, "options"_a)
      .def("set_interfaces", &set_interfaces, "interfaces"_a)
      .def("set_curves",
           [](Core& c, const std::vector<std::vector<Real>>& times,
              const std::vector<std::vector<Real>>& factors) {
             c.model.curve_time = times;
             c.model.curve_factor = factors;
             set_loads_and_supports(c.model, c.state);
           })
      .def("set_gravity",
           [](Core& c, const std::vector<Real>& g) {
             c.model.gravity = {g.at(0), g.at(1), g.at(2)};
           })
      .def("set_damping",
           [](Core& c, Real local, Real mass, Real stiffness, Real contact) {
             c.model.damping = {local, mass};
             c.model.stiffness_damping = stiffness;
             c.model.contact_damping = contact;
           })
      .def("set_lumped", [](Core& c, bool lumped) { c.model.lumped = lumped; })
      .def("change_mass", [](Core& c, bool lumped) { change_mass(c.model, c.state, lumped); })
      .def("start",
           [](Core& c, Array<Real> position) { init_state(c.model, c.state, position.data()); })
      .def("restore", &restore)
      .def("prepare", [](Core& c) { prepare(c.model, c.state); })
      .def("renew_step", [](Core& c) { renew_step(c.model, c.state); })
      .def("fields", &state_fields)
      .def("scalars", &scalars)
      .def("describe_scalars", &scalar_infos)
      .def(
          "run",
          [](Core& c, std::int64_t steps, Real end_time, Real unbalance_limit,
             std::int64_t check_interval, const std::string& way) {
            const Relaxation relax = relaxation(way);
            Report r;
            {
              nb::gil_scoped_release release;
              r = run(c.model, c.state, {steps, end_time, unbalance_limit, check_interval, relax});
            }
            return std::make_tuple(std::string(name_of(r.outcome)), r.culprit, r.value);
          },
          "steps"_a, "end_time"_a = 1e300, "unbalance_limit"_a = 0.0, "check_interval"_a = 20,
          "relaxation"_a = "none")
      .def("energies", &energy_ledger)
      .def("seconds",
           [](const Core& c) {
             const Real* t = c.state.seconds;
             return std::make_tuple(t[0], t[1], t[2], t[3], t[4]);
           })
      .def("unbalance_ratio", [](const Core& c) { return unbalance_ratio(c.model, c.state); })
      .def("step_limit",
           [](const Core& c) {
             const StepLimit l = step_limit(c.model, c.state);
             return std::make_tuple(l.dt, l.node, l.element_frequency_squared,
                                    l.contact_frequency_squared);
           })
      .def("node_force",
           [](nb::handle_t<Core> self) {
             return view(nb::cast<Core&>(self).state.nodes.force, self);
           })
      .def("stress",
           [](nb::handle_t<Core> self) {
             Core& c = nb::cast<Core&>(self);
             report_stress(c.model, c.state);
             nb::dict d;
             for_each_element_set(c.model, c.state,
                                  [&](const auto& kind, const ElementSet&, ElementState& es) {
                                    d[kind.name] = view(es.stress, self);
                                  });
             return d;
           })
      .def("adopt_overlaps",
           [](Core& c) {
             const InitialOverlaps found = adopt_overlaps(c.model, c.state);
             return std::make_tuple(found.deepest, found.count, found.face);
           })
      .def("keep_energy_scale", [](Core& c) { keep_energy_scale(c.model, c.state); });
}
