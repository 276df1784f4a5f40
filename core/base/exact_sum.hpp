// exact_sum.hpp - sums with the same bits for any order of their terms: the words
// of such a sum. `exact_sum` of primitives.hpp makes them.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/exchange.hpp"
#include "core/base/lanes.hpp"

namespace cdem {

/// A sum of numbers without round-off: digits of 32 bits, from the smallest number to 2^973, as
/// integers. These add up to the same in any order, so a sum may be made of parts.
class ExactSum {
 public:
  static constexpr Index most = 1024;  // numbers at a time
  static constexpr int digits = 64, digit_bits = 32;
  static constexpr int lowest = -1074;      // the unit of digit 0 is two to this power
  static constexpr int too_large = 973;     // two to this power is
  static constexpr int words = digits + 1;  // behind the digits: how many were none or too large

  /// Add numbers, which are lost; behind them there is room up to `most`. For all parts of a sum
  /// together up to 2^31.
  void add(Real* numbers, Index count);
  /// Add a part given by its words.
  void add(const std::int64_t* part);
  void add(const ExactSum& part) { add(part.word_.data()); }
  /// Add the parts of all other ranks; null: there are none.
  void add_ranks(Exchange* ranks) {
    if (ranks) ranks->add_up(word_.data(), words);
  }
  /// Within two units in the last place; no number if one of them was none or too large.
  Real value() const;

 private:
  std::array<std::int64_t, words> word_{};
};

/// A number as words of an exact sum, which a device adds up: two or three digits side by side, or
/// 1 behind the digits. Their unit is as in ExactSum, so the sum is the same integer.
class NumberDigits {
 public:
  CDEM_HD explicit NumberDigits(Real number) {
    constexpr int fraction_bits = 52, bias = 1023;
    const std::uint64_t bits = bits_of(number);
    const int exponent = int(bits >> fraction_bits & 0x7ff);
    if (exponent >= bias + ExactSum::too_large) {
      first_ = last_ = ExactSum::digits;
      low_ = 1;
      return;
    }
    std::uint64_t whole = bits & ((std::uint64_t(1) << fraction_bits) - 1);
    if (exponent > 0) whole |= std::uint64_t(1) << fraction_bits;
    if (whole == 0) return;
    const int place = exponent > 0 ? exponent - 1 : 0;  // of the last bit, counted from the lowest
    const int shift = place % ExactSum::digit_bits;
    low_ = whole << shift;
    high_ = shift > 0 ? whole >> (64 - shift) : 0;
    first_ = place / ExactSum::digit_bits;
    last_ = first_ + (high_ != 0 ? 2 : 1);
    negative_ = bits >> 63 != 0;
  }

  /// Its next word below this one, or -1.
  CDEM_HD int below(int word) const {
    const int next = word - 1 < last_ ? word - 1 : last_;
    return next >= first_ ? next : -1;
  }
  /// Its part of a word.
  CDEM_HD std::int64_t at(int word) const {
    std::uint64_t size = 0;
    if (word == first_) size = low_ & 0xffffffff;
    if (word == first_ + 1) size = low_ >> ExactSum::digit_bits;
    if (word == first_ + 2) size = high_;
    return negative_ ? -std::int64_t(size) : std::int64_t(size);
  }
  /// Add it to a sum that nothing else adds to.
  CDEM_HD void add_to(std::int64_t* words) const {
    for (int k = below(ExactSum::words); k >= 0; k = below(k)) words[k] += at(k);
  }

 private:
  std::uint64_t low_ = 0, high_ = 0;  // the digits from the first on
  int first_ = 0, last_ = -1;
  bool negative_ = false;
};

}  // namespace cdem
