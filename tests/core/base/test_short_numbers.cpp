// Numbers in 16 bits are on the side that they are rounded to, and not far.
#include <vector>

#include "core/base/short_numbers.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// A number in 16 bits and back.
Real kept(Real number) {
  Short bits = 0;
  store(&bits, One{0}, number);
  return InBounds{&bits, 1}.at(0, One{0});
}

}  // namespace

TEST_CASE("a number is rounded to the side asked for, by less than a part in 128") {
  Random random(1);
  for (int n = 0; n < 10000; ++n) {
    const Real size = std::pow(10.0, random.between(-30, 30));
    const Real number = (n % 2 ? size : -size) * random.between(1, 2);
    const Real up = round_up(number), down = round_down(number);
    CHECK(kept(up) == up);
    CHECK(kept(down) == down);
    CHECK(up > number);
    CHECK(down < number);
    CHECK(up - down <= std::abs(number) / 128);
  }
}

TEST_CASE("numbers that 16 bits hold stay") {
  for (const Real number :
       {0.0, 1.0, -1.0, 3.0, 15.0, 0.5, 255.0, -1.9921875, infinity, -infinity}) {
    CHECK(kept(round_up(number)) == number);
    CHECK(kept(round_down(number)) == number);
  }
  CHECK(round_up(std::nextafter(1.0, 2.0)) == 1.0078125);
  CHECK(round_down(std::nextafter(1.0, 0.0)) == 0.99609375);
}

TEST_CASE("tiny and huge numbers stay on their side") {
  for (const Real number : {1e-300, 1e-40, 1e-38}) {
    CHECK(kept(round_up(number)) > number);
    CHECK(kept(round_down(number)) == 0);
    CHECK(kept(round_up(-number)) == 0);
    CHECK(kept(round_down(-number)) < -number);
  }
  CHECK(kept(round_up(1e300)) == infinity);
  CHECK(kept(round_down(-1e300)) == -infinity);
}

TEST_CASE("packs are rounded, written and read as single numbers are") {
  Random random(2);
  std::vector<Short> one(4 * lanes), pack(4 * lanes);
  for (int n = 0; n < 1000; ++n) {
    Pack numbers;
    for (Index j = 0; j < lanes; ++j)
      numbers.n[j] = random.between(-1, 1) * std::pow(10.0, random.between(-45, 10));
    const Pack up = round_up(numbers), down = round_down(numbers);
    for (Index j = 0; j < lanes; ++j) {
      CHECK(up.n[j] == round_up(Real(numbers.n[j])));
      CHECK(down.n[j] == round_down(Real(numbers.n[j])));
      store(one.data(), One{lanes + j}, up.n[j]);
    }
    store(pack.data(), Lane{lanes}, up);
    CHECK(pack == one);
    const Pack read = InBounds{pack.data(), lanes}.at(1, Lane{0});
    for (Index j = 0; j < lanes; ++j) CHECK(read.n[j] == up.n[j]);
  }
}

}  // namespace cdem::test
