// emulated.cpp - see emulated.hpp.
#include "core/base/emulated.hpp"

#if defined(CDEM_EMULATED)

#include <cxxabi.h>
#include <dlfcn.h>
#include <execinfo.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <new>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Of the library: from its first byte to its last.
extern "C" __attribute__((visibility("hidden"))) const char __ehdr_start[], _end[];

namespace cdem {
inline namespace CDEM_DEVICE {

namespace {

constexpr std::size_t page = 4096, arena_size = std::size_t(16) << 30;

/// Who touched the bytes of a word in a launch: the item that did so last, and those before it.
/// Items run one after the other, so none of those comes again.
struct Word {
  std::uint32_t launch, item;
  struct Bytes {
    std::uint8_t read, written, raised;  // a bit for each byte; raised: atomically, or read so
  } here, before;
};

/// Accesses seen while a kernel runs. Hooks and handler use plain memory only: what they call must
/// not call them.
struct Watch {
  char* arena;       // arrays
  Word* words;       // one for 8 bytes of the arena
  std::size_t* end;  // of the array on each page, or 0
  std::size_t top;   // of the arena
  std::uint32_t launch, item;
  const char* stack_end;  // of a launch: where its work ends
  bool in_run;
  struct {
    const void* instruction;
    const char* what;
  } fault;  // the first of the launch
} watch;

/// Does this thread run a launch?
__attribute__((tls_model("initial-exec"))) thread_local bool launching = false;

enum class Way { read, write, raise };

/// Is this on the stack, or a constant?
inline bool is_own(const char* address) {
  return (address >= static_cast<const char*>(__builtin_frame_address(0)) &&
          address < watch.stack_end) ||
         (address >= __ehdr_start && address < _end);
}

inline void note(const void* instruction, const char* what) {
  if (!watch.fault.what) watch.fault = {instruction, what};
}

inline void touch_word(Word& word, unsigned bytes, Way way, const void* instruction) {
  if (word.launch != watch.launch) word = {watch.launch, watch.item, {}, {}};
  if (word.item != watch.item) {
    word.before.read |= word.here.read;
    word.before.written |= word.here.written;
    word.before.raised |= word.here.raised;
    word.here = {};
    word.item = watch.item;
  }
  const Word::Bytes& others = word.before;
  if (way == Way::read) {
    word.here.read |= bytes;
    if (bytes & (others.written | others.raised)) note(instruction, "reads what another wrote");
  } else if (way == Way::write) {
    word.here.written |= bytes;
    if (bytes & (others.written | others.raised)) note(instruction, "writes what another wrote");
    if (bytes & others.read) note(instruction, "writes what another read");
  } else {
    word.here.raised |= bytes;
    if (bytes & (others.written | others.read)) note(instruction, "raises what another touched");
  }
}

inline void touch(const void* memory, std::size_t size, Way way, const void* instruction) {
  if (!launching) return;
  const char* address = static_cast<const char*>(memory);
  const std::size_t first = std::size_t(address - watch.arena);
  if (first >= arena_size) {
    if (watch.in_run && !is_own(address)) note(instruction, "touches memory of the host");
    return;
  }
  if (first + size > watch.end[first / page])
    return note(instruction, "touches memory of no array");
  for (std::size_t at = first; at < first + size;) {
    const std::size_t in_word = at % 8, here = std::min(8 - in_word, first + size - at);
    touch_word(watch.words[at / 8], ((1u << here) - 1) << in_word, way, instruction);
    at += here;
  }
}

/// Accesses of host code between launches.
struct Host {
  HostWatch watch = HostWatch::none;
  bool open = true;
  int transfers = 0;  // that live
  struct sigaction action_before{};
  std::int64_t launches = 0, waits = 0, transfers_made = 0;
  bool in_flight = false;  // was anything launched since the last wait?
  bool queues = true;
  std::string fault;
  std::map<char*, std::size_t> taken;
  std::multimap<std::size_t, char*> free;
  std::mt19937 random;
};
Host& host() {
  static Host one;
  return one;
}

/// A launch that waits for its turn.
struct Launch {
  Index count;
  const char* kernel;
  void (*run)(const void* work, Index i);
  std::vector<char> work;
};
std::deque<Launch>& queued() {
  static std::deque<Launch> one;
  return one;
}

constexpr std::size_t most_places = 1 << 12;
HostAccess places[most_places];
std::atomic_flag counting;
/// How often the arena was closed, and after which of these a page was opened to be read.
std::uint32_t closings = 0, readable[arena_size / page];

void open(bool yes) {
  if (yes && host().open) return;
  if (mprotect(watch.arena, watch.top, yes ? PROT_READ | PROT_WRITE : PROT_NONE) != 0)
    throw std::runtime_error("the emulated device cannot protect its arena");
  closings += !yes;
  host().open = yes;
}
/// The arena is open in launches, in transfers, and where no run goes on.
void open_or_close() {
  open(host().watch == HostWatch::none || launching || host().transfers > 0 || !watch.in_run);
}

/// The instruction of the core that caused a fault, even if it happened in a function that it
/// called.
std::uintptr_t place_of_fault() {
  void* calls[16];
  const int depth = backtrace(calls, 16);
  const auto is_ours = [](const void* p) { return p >= __ehdr_start && p < _end; };
  int k = 0;
  while (k < depth && is_ours(calls[k])) ++k;   // the handler
  while (k < depth && !is_ours(calls[k])) ++k;  // skips the system and called functions
  return k < depth ? std::uintptr_t(static_cast<const char*>(calls[k]) - __ehdr_start) : 0;
}

void count(std::uintptr_t place, bool writes) {
  while (counting.test_and_set()) {
  }
  std::size_t k = place % most_places;
  while (places[k].place != 0 && places[k].place != place) k = (k + 1) % most_places;
  places[k].place = place;
  ++(writes ? places[k].writes : places[k].reads);
  counting.clear();
}

/// Opens a page to be read, and at its next fault, to be written.
void handle(int, siginfo_t* info, void*) {
  const std::size_t at = std::size_t(static_cast<char*>(info->si_addr) - watch.arena);
  if (at >= watch.top) {  // a fault like any other
    std::signal(SIGSEGV, SIG_DFL);
    return;
  }
  const std::uintptr_t place = place_of_fault();
  if (host().watch == HostWatch::strict) {
    Dl_info library{};
    dladdr(__ehdr_start, &library);
    std::fprintf(stderr, "emulated device: host code at 0x%zx of %s touches an array in a run\n",
                 std::size_t(place), library.dli_fname);
    std::_Exit(70);
  }
  std::uint32_t& readable_since = readable[at / page];
  const bool writes = readable_since == closings;
  readable_since = closings;
  count(place, writes);
  mprotect(watch.arena + at / page * page, page, writes ? PROT_READ | PROT_WRITE : PROT_READ);
}

/// Address space alone: pages become memory when they are touched.
void* reserve(std::size_t size) {
  void* memory = mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return memory;
}

void start() {
  watch.arena = static_cast<char*>(reserve(arena_size));
  const auto take = [](std::size_t bytes) {
    void* const memory = reserve(bytes);
    mprotect(memory, bytes, PROT_READ | PROT_WRITE);
    return memory;
  };
  watch.words = static_cast<Word*>(take(arena_size / 8 * sizeof(Word)));
  watch.end = static_cast<std::size_t*>(take(arena_size / page * sizeof *watch.end));
  const char* seed = std::getenv("CDEM_EMULATED_SEED");
  host().random.seed(seed ? std::uint32_t(std::strtoul(seed, nullptr, 10)) : 1);
  const char* given = std::getenv("CDEM_EMULATED_HOST");
  const std::string words = given ? given : "none";
  host().watch = words == "count"    ? HostWatch::count
                 : words == "strict" ? HostWatch::strict
                                     : HostWatch::none;
  void* one;
  backtrace(&one, 1);  // loads its library before a handler calls it
}

/// A fault of a kernel.
std::string told(const char* kernel) {
  int status = 0;
  char *name = abi::__cxa_demangle(kernel, nullptr, nullptr, &status), place[32];
  const auto* at = static_cast<const char*>(watch.fault.instruction);
  std::snprintf(place, sizeof place, "0x%zx", std::size_t(at - __ehdr_start));
  const std::string text = std::string("kernel ") + (name ? name : kernel) + ": an item " +
                           watch.fault.what + ", at " + place + " of the library";
  std::free(name);
  return text;
}

void run(const Launch& one) {
  std::vector<Index> order(static_cast<std::size_t>(one.count));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), host().random);
  char* const work = static_cast<char*>(__builtin_alloca_with_align(one.work.size(), 8 * 64));
  std::memcpy(work, one.work.data(), one.work.size());  // kernels may read their stack
  ++watch.launch;
  watch.item = 0, watch.fault = {}, watch.stack_end = work + one.work.size();
  launching = true;
  open_or_close();
  for (const Index i : order) ++watch.item, one.run(work, i);
  launching = false;
  open_or_close();
}

/// Run what was launched, up to the first fault, which `finish` tells.
void run_queued() {
  while (!queued().empty() && host().fault.empty()) {
    const Launch one = std::move(queued().front());
    queued().pop_front();
    run(one);
    if (watch.fault.what) host().fault = told(one.kernel);
  }
}

}  // namespace

namespace {
/// An array on these pages ends after so many bytes.
void set_ends(const char* memory, std::size_t size, std::size_t bytes) {
  const std::size_t first = std::size_t(memory - watch.arena);
  std::fill_n(&watch.end[first / page], size / page, bytes > 0 ? first + bytes : 0);
}
}  // namespace

void* allocate_answer(std::size_t bytes) { return allocate(bytes); }
void* allocate(std::size_t bytes) {
  if (!watch.arena) start();
  const std::size_t size = (bytes + page - 1) / page * page;
  const auto same = host().free.find(size);
  char* memory = watch.arena + watch.top;
  if (same != host().free.end()) {
    memory = same->second;
    host().free.erase(same);
    madvise(memory, size, MADV_DONTNEED);  // zeros again
  } else {
    if (watch.top + size + page > arena_size) throw std::bad_alloc();
    watch.top += size + page;  // a page of no array behind it
    if (host().open) mprotect(memory, size + page, PROT_READ | PROT_WRITE);
  }
  host().taken[memory] = size;
  set_ends(memory, size, bytes);
  return memory;
}
void release(void* memory) {
  if (!memory) return;
  run_queued();  // they may be using it
  const auto one = host().taken.find(static_cast<char*>(memory));
  host().free.emplace(one->second, one->first);
  set_ends(one->first, one->second, 0);
  host().taken.erase(one);
}
void finish(Queue) {
  run_queued();
  queued().clear();
  if (!host().fault.empty()) throw std::logic_error(std::exchange(host().fault, {}));
  host().waits += host().in_flight;
  host().in_flight = false;
}
bool runs_alone() { return false; }
const char* device_name() { return "emulated"; }

RunOnDevice::RunOnDevice() {
  struct sigaction action{};
  action.sa_sigaction = handle;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  sigaction(SIGSEGV, &action, &host().action_before);
  watch.in_run = true;
  open_or_close();
}
RunOnDevice::~RunOnDevice() {
  watch.in_run = false;
  open_or_close();
  sigaction(SIGSEGV, &host().action_before, nullptr);
}
Transfer::Transfer() { ++host().transfers, ++host().transfers_made, open_or_close(); }
Transfer::~Transfer() { --host().transfers, open_or_close(); }

void launch(Index count, const char* kernel, void (*run)(const void* work, Index i),
            const void* work, std::size_t bytes) {
  const char* const first = static_cast<const char*>(work);
  ++host().launches;
  host().in_flight = true;
  queued().push_back({count, kernel, run, {first, first + bytes}});
  if (!host().queues) finish({});
}

void queue_launches(bool yes) {
  finish({});
  host().queues = yes;
}

Seen seen() {
  Seen all{host().launches, host().waits, host().transfers_made, {}};
  for (const HostAccess& one : places)
    if (one.place != 0) all.host.push_back(one);
  return all;
}
void forget() {
  host().launches = host().waits = host().transfers_made = 0;
  std::fill(places, places + most_places, HostAccess{});
}
void watch_host(HostWatch how) {
  if (!watch.arena) start();
  host().watch = how;
}

}  // namespace CDEM_DEVICE
}  // namespace cdem

// Functions that the compiler calls before every access to memory, and in place of atomic
// operations.
using namespace cdem;

extern "C" {

#define CDEM_TOUCH(name, size, way) \
  void __tsan_##name(void* p) { touch(p, size, Way::way, __builtin_return_address(0)); }
#define CDEM_TOUCHES(size)                     \
  CDEM_TOUCH(read##size, size, read)           \
  CDEM_TOUCH(write##size, size, write)         \
  CDEM_TOUCH(unaligned_read##size, size, read) \
  CDEM_TOUCH(unaligned_write##size, size, write)
CDEM_TOUCHES(1)
CDEM_TOUCHES(2)
CDEM_TOUCHES(4)
CDEM_TOUCHES(8)
CDEM_TOUCHES(16)
void __tsan_read_range(void* p, std::size_t n) {
  touch(p, n, Way::read, __builtin_return_address(0));
}
void __tsan_write_range(void* p, std::size_t n) {
  touch(p, n, Way::write, __builtin_return_address(0));
}

#define CDEM_ATOMIC(bits, type)                                                                  \
  type __tsan_atomic##bits##_load(const volatile type* p, int) {                                 \
    touch(const_cast<const type*>(p), bits / 8, Way::raise, __builtin_return_address(0));        \
    return __atomic_load_n(p, __ATOMIC_SEQ_CST);                                                 \
  }                                                                                              \
  void __tsan_atomic##bits##_store(volatile type* p, type value, int) {                          \
    touch(const_cast<type*>(p), bits / 8, Way::raise, __builtin_return_address(0));              \
    __atomic_store_n(p, value, __ATOMIC_SEQ_CST);                                                \
  }                                                                                              \
  type __tsan_atomic##bits##_fetch_add(volatile type* p, type value, int) {                      \
    touch(const_cast<type*>(p), bits / 8, Way::raise, __builtin_return_address(0));              \
    return __atomic_fetch_add(p, value, __ATOMIC_SEQ_CST);                                       \
  }                                                                                              \
  type __tsan_atomic##bits##_fetch_or(volatile type* p, type value, int) {                       \
    touch(const_cast<type*>(p), bits / 8, Way::raise, __builtin_return_address(0));              \
    return __atomic_fetch_or(p, value, __ATOMIC_SEQ_CST);                                        \
  }                                                                                              \
  int __tsan_atomic##bits##_compare_exchange_weak(volatile type* p, type* old, type value, int,  \
                                                  int) {                                         \
    touch(const_cast<type*>(p), bits / 8, Way::raise, __builtin_return_address(0));              \
    return __atomic_compare_exchange_n(p, old, value, true, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST); \
  }
CDEM_ATOMIC(8, char)
CDEM_ATOMIC(32, int)
CDEM_ATOMIC(64, long)

void __tsan_init() {}
void __tsan_func_entry(void*) {}
void __tsan_func_exit() {}
void __tsan_vptr_update(void*, void*) {}
void __tsan_vptr_read(void*) {}

}  // extern "C"

#endif
