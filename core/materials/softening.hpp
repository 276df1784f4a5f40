// softening.hpp - strengths of a block law that fall with the slip across a band of elements.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Straight pieces that a strength falls in.
inline constexpr Index fall_pieces = 7;
/// Numbers of a law that may fall: the first four with the first two of its state, the next four
/// with the next two; of each four, the last (a tensile strength) with the plastic strain in
/// tension.
inline constexpr Index falling_numbers = 8;
/// Numbers of a piece: the slip where it begins [m], its length [m], and how the number changes
/// over it, per metre.
inline constexpr Index piece_numbers = 3;
/// Numbers that a material has for it: whether it softens, and the pieces.
inline constexpr Index softening_numbers = 1 + falling_numbers * fall_pieces * piece_numbers;

/// The number of a state that number k falls with.
CDEM_HD constexpr Index falls_with(Index k) { return 2 * (k / 4) + (k % 4 == 3); }

/// Number k of a law after this slip; `piece(i)` is number i of the material's softening.
template <class T, class Piece>
CDEM_HD inline T after_slip(T number, Index k, const T& slip, const Piece& piece) {
  for (Index s = 0; s < fall_pieces; ++s) {
    const Index first = 1 + (k * fall_pieces + s) * piece_numbers;
    const T begin = piece(first);
    if (!any_of(slip > begin)) break;
    const T run = min_of(max_of(slip - begin, T(0.0)), piece(first + 1));
    number += piece(first + 2) * run;
  }
  return number;
}

}  // namespace cdem
