// check.hpp - is the run healthy? Energy ledger, unbalance ratio, stable step, finite numbers.
#pragma once

#include "core/step.hpp"

namespace cdem {

/// The stable step is found anew every so many steps, after every refresh of the search, and after
/// every step with contacts.
inline constexpr std::int64_t step_check_interval = 100;

/// A step is at most this much longer than the last. A sudden change from w dt = 1.6 to nothing or
/// back multiplies the energy of a mode by chance, both together by 1.28 on average; a slow one
/// does not (docs/theory). Contacts that come and go shorten the step and set it free again and
/// again.
inline constexpr Real step_growth = 1.01;

/// Step of adaptive relaxation, as a part of the stable one: its masses are made for it, from
/// bounds that hold.
inline constexpr Real relax_safety = 0.9;

/// Sum in a fixed order whatever the number of threads: fixed chunks, then the chunks in turn.
template <class Term>
Real ordered_sum(Index count, Term&& term) {
  constexpr Index chunk = 1024;
  const Index chunks = (count + chunk - 1) / chunk;
  std::vector<Real> part(chunks);
#pragma omp parallel for schedule(static) if (count >= worth_threads)
  for (Index c = 0; c < chunks; ++c) {
    Real sum = 0;
    const Index last = c + 1 == chunks ? count : (c + 1) * chunk;
    for (Index i = c * chunk; i < last; ++i) sum += term(i);
    part[c] = sum;
  }
  Real sum = 0;
  for (const Real p : part) sum += p;
  return sum;
}

void sample_before(const Model& model, State& state, Queue queue);
void sample_after(const Model& model, State& state, Queue queue);
Real kinetic_energy(const Model& model, const State& state);
Report check_health(const Model& model, const State& state);
/// Renew centre, normal and sharp sides of every exposed face; those sides only where there are
/// candidates, unless `all`.
void update_face_geometry(const Model& model, State& state, Queue queue, bool all);
/// After every step: longer if it may be.
void grow_step(State& state);
/// Do the lists name anything? Without it contacts only end, in the first step with these lists.
bool may_have_contacts(const State& state);
/// Stiffness that bonds and possible contacts put on each node.
void sum_stiffness(const Model& model, State& state);

}  // namespace cdem
