// main.cpp - runs the tests of the core.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "core/base/emulated.hpp"

int main(int count, char** words) {
#if defined(CDEM_EMULATED)
  cdem::queue_launches(false);  // tests look at arrays without waiting
#endif
  return doctest::Context(count, words).run();
}
