// Memory that was given back and is taken again.
#include <cstdlib>
#include <set>

#include "core/base/spare_memory.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// A source that counts, and has no more than some memory.
struct Counted {
  static inline std::map<void*, std::size_t> out;
  static inline std::size_t taken, most;

  static std::size_t bytes() {
    std::size_t sum = 0;
    for (const auto& [memory, size] : out) sum += size;
    return sum;
  }
  static void* take(std::size_t size) {
    if (bytes() + size > most) return nullptr;
    void* const memory = std::malloc(1);
    out[memory] = size;
    ++taken;
    return memory;
  }
  static void give(void* memory) {
    out.erase(memory);
    std::free(memory);
  }
  static void begin(std::size_t bytes) { out.clear(), taken = 0, most = bytes; }
};
using Spare = SpareMemory<Counted>;
constexpr std::size_t mega = std::size_t(1) << 20;

}  // namespace

TEST_CASE("blocks have room for what is asked, and are no more than an eighth larger") {
  Random random(3);
  for (int times = 0; times < 2000; ++times) {
    const std::size_t bytes = random.below(1 << random.below(28)) + 1;
    const std::size_t size = Spare::size_of_block(bytes);
    CHECK(size >= bytes);
    CHECK(size <= std::max<std::size_t>(bytes + bytes / 8 + 512, 512));
    CHECK(size % 512 == 0);
    CHECK(Spare::size_of_block(size) == size);
  }
}

TEST_CASE("memory that is given back is taken again for arrays of about the same size") {
  Counted::begin(1000 * mega);
  Spare spare;
  for (int times = 0; times < 50; ++times) {
    void* const one = spare.take(1000000 + 100 * times);
    void* const other = spare.take(1000000);
    CHECK(one != other);
    spare.give(one);
    spare.give(other);
  }
  CHECK(Counted::taken == 2);
}

TEST_CASE("what is kept is bounded, and none is kept where the source has no more") {
  Counted::begin(1000 * mega);
  Spare spare;
  std::set<void*> all;
  for (int k = 0; k < 40; ++k) all.insert(spare.take(10 * mega));
  for (void* const one : all) spare.give(one);
  CHECK(Counted::bytes() <= Spare::always);
  CHECK(Counted::bytes() > Spare::always / 2);
  Counted::most = 100 * mega;
  void* const large = spare.take(90 * mega);
  CHECK(Counted::bytes() < 100 * mega);
  CHECK_THROWS_AS(spare.take(20 * mega), std::bad_alloc);
  spare.give(large);
  CHECK(Counted::bytes() == 0);  // more than may be kept
}

}  // namespace cdem::test
