// emulated.hpp - a device on the CPU that finds faults of GPU code, and counts.
//
// Arrays lie in an arena that host code cannot reach while a run goes on, except in a Transfer: the
// pages that it touches are counted by instruction. Launches lie in a queue until host code waits
// for them, so code that forgets to wait always finds old numbers. Kernels run item by item, in
// another order at every launch. The compiler tells of their accesses to memory
// (`-fsanitize=thread`, with functions of our own in place of its library), so items that need each
// other's order are found whatever the order was. Only the emulated core has this.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/device.hpp"
#include "core/base/lanes.hpp"

namespace cdem {
inline namespace CDEM_DEVICE {

/// Host code that touched arrays in a run, outside of transfers: by its place in the library, how
/// many pages it was the first to touch, and the first to write after that.
struct HostAccess {
  std::uintptr_t place;
  std::int64_t reads, writes;
};

/// Counts of the device; waits count launches not yet waited for.
struct Seen {
  std::int64_t launches, waits, transfers;
  std::vector<HostAccess> host;
};

/// Counts since `forget`.
Seen seen();
void forget();

/// Treatment of host code that touches arrays in a run: ignored, counted, or it ends the
/// program with status 70. Begins as CDEM_EMULATED_HOST, which is none, count or strict.
enum class HostWatch { none, count, strict };
void watch_host(HostWatch watch);

/// Whether launches run when host code waits for them, as they do at the start, or at once.
void queue_launches(bool yes);

/// Launch a kernel: `run(work, i)` for each of `count` items, in an order of this launch alone,
/// which CDEM_EMULATED_SEED changes. `work`, some bytes, is copied.
///
/// Whoever waits for it gets std::logic_error if an item depends on another one, or touches in a
/// run memory that is no array.
void launch(Index count, const char* kernel, void (*run)(const void* work, Index i),
            const void* work, std::size_t bytes);

}  // namespace CDEM_DEVICE
}  // namespace cdem
