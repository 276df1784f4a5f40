// share.hpp - the part of a model that a rank has.
#pragma once

#include <map>
#include <string>

#include "core/base/column.hpp"
#include "core/base/exchange.hpp"

namespace cdem {

/// A rank has the elements that it owns, and ghosts: elements of others near them. Each item of a
/// model is owned by one rank. The motion of a node that is not own comes from its owner. A whole
/// model has none of this.
struct Share {
  Exchange* exchange = nullptr;                             // null: the model is whole
  std::map<std::string, Column<Flag>, std::less<>> own;     // [row] by kind of rows
  std::map<std::string, Column<Index>, std::less<>> tiles;  // [eight elements] tile, by set
  Column<Index> node, face;      // [node], [face] their numbers in the whole model
  Column<Index> block;           // [node] its block there
  Column<Index> cut_block;       // [node] number of its block among those that several ranks own
  Index cut_blocks = 0;          // or -1
  Column<Index> send, receive;   // nodes, in the order of Exchange::swap
  Column<Real> out, in;          // their rows on the way
  Column<Real> fence;            // rows of 8, see LeavesFence
  bool pairs_elsewhere = false;  // do the pair lists of other ranks name any?

  /// Rows of a kind in sums over all ranks.
  Counted counted(std::string_view kind) const {
    if (!exchange) return {};
    const auto found = own.find(kind);
    return {found != own.end() ? found->second.data() : nullptr, exchange};
  }
};

}  // namespace cdem
