// block_lists.hpp - which blocks of consecutive items a step runs.
#pragma once

#include "core/base/parallel.hpp"
#include "core/model/state.hpp"
#include "core/records/step_plan.hpp"

namespace cdem {

/// Blocks with an item for which `is_awake` holds.
template <class Test>
void list_blocks(Index count, Column<Index>& list, Test&& is_awake) {
  std::vector<Index> blocks;
  for (Index first = 0; first < count; first += block_size) {
    bool any = false;
    for (Index i = first; !any && i < first + block_size && i < count; ++i) any = is_awake(i);
    if (any) blocks.push_back(first / block_size);
  }
  list.assign(blocks);
}

/// The blocks of a list, or all of them where the plan wants everything awake.
inline Blocks awake(const StepPlan& plan, const Column<Index>& list) {
  static constexpr Index none = 0;  // a null pointer would stand for all
  if (plan.everything_awake) return {};
  return {list.size() > 0 ? list.data() : &none, Index(list.size())};
}

/// Does the fused kernel run in this step?
inline bool fuses_blocks(const State& s, const StepPlan& plan) {
  return plan.fuse_blocks && s.nodes.fused.size() > 0;
}

}  // namespace cdem
