// A list of laws that code can go through.
#include <array>
#include <vector>

#include "core/records/law_list.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

template <class T>
struct Two {
  static constexpr std::array<int, 2> parameters{};
  static constexpr std::array<int, 0> state{};
};
template <class T>
struct Five {
  static constexpr std::array<int, 5> parameters{};
  static constexpr std::array<int, 1> state{};
};

}  // namespace

TEST_CASE("a list calls for its laws in order, with their numbers") {
  using Laws = LawList<Two, Five, Two>;
  std::vector<std::size_t> sizes;
  std::vector<Index> numbers;
  Laws::for_each([&]<template <class> class Law, Index number>() {
    sizes.push_back(Law<Real>::parameters.size());
    numbers.push_back(number);
  });
  CHECK(sizes == std::vector<std::size_t>{2, 5, 2});
  CHECK(numbers == std::vector<Index>{0, 1, 2});
  CHECK(Laws::count == 3);
}

TEST_CASE("a list knows the most parameters and state of its laws") {
  CHECK(LawList<Two, Five>::most_parameters == 5);
  CHECK(LawList<Two, Five>::most_state == 1);
  CHECK(LawList<Two>::most_state == 0);
  CHECK(largest_of(3, 9, 4) == 9);
}

}  // namespace cdem::test
