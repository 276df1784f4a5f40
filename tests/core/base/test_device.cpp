// Memory of the CPU.
#include <string>

#include "core/base/device.hpp"
#include "core/base/openmp.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("memory begins as zeros at a cache line") {
  // large arrays have pages of their own
  constexpr std::size_t mega = std::size_t(1) << 20;
  for (const std::size_t bytes : {std::size_t(1), std::size_t(63), std::size_t(1000), mega - 65,
                                  mega - 64, mega - 63, mega, 5 * mega + 1})
    for (int times = 0; times < 2; ++times) {
      auto* memory = static_cast<unsigned char*>(allocate(bytes));
      CHECK(reinterpret_cast<std::uintptr_t>(memory) % 64 == 0);
      CHECK(std::all_of(memory, memory + bytes, [](unsigned char c) { return c == 0; }));
      std::fill(memory, memory + bytes, 1);
      release(memory);
    }
}

#if defined(CDEM_CPU)
TEST_CASE("the CPU is the device, alone if it has one thread") {
  CHECK(std::string(device_name()) == "cpu");
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  CHECK(runs_alone());
#if defined(_OPENMP)
  omp_set_num_threads(2);
  CHECK(!runs_alone());
#endif
  omp_set_num_threads(threads);
}
#endif

}  // namespace cdem::test
