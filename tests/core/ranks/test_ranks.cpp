// Decisions, sums and rows of ranks, beside another rank that is made up.
#include <algorithm>
#include <cstring>

#include "core/base/primitive_loops.hpp"
#include "core/ranks/ranks.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

/// This rank and one that says given things.
class Pair : public Exchange {
 public:
  std::int64_t word = 0;            // that the other rank adds to each
  Real value = 0;                   // that it gives where numbers are gathered
  std::vector<Real> rows, learned;  // that it sends, and that it has received

  int count() const override { return 2; }
  void add_up(std::int64_t* words, Index number) override {
    for (Index k = 0; k < number; ++k) words[k] += word;
  }
  void gather(const void* own, std::size_t bytes, void* all) override {
    std::memcpy(all, own, bytes);
    std::memcpy(static_cast<char*>(all) + bytes, &value, bytes);
  }
  void swap(const Real* send, Index sent, Real* receive, Index received, Index numbers) override {
    learned.assign(send, send + std::size_t(sent) * numbers);
    std::copy_n(rows.begin(), std::size_t(received) * numbers, receive);
  }
};

}  // namespace

TEST_CASE("one rank decides for all; a whole model by itself") {
  State s;
  CHECK_FALSE(any_rank(s, false));
  CHECK(any_rank(s, true));
  CHECK(of_all_ranks(s, 3.0) == std::vector<Real>{3});
  Pair other;
  s.share.exchange = &other;
  CHECK_FALSE(any_rank(s, false));
  CHECK(any_rank(s, true));
  other.word = 1;
  CHECK(any_rank(s, false));
  other.value = 7;
  CHECK(of_all_ranks(s, 3.0) == std::vector<Real>{3, 7});
}

TEST_CASE("rows of ghosts come from their owners, pads stay") {
  State s;
  Pair other;
  s.share.exchange = &other;
  s.share.send.assign(std::vector<Index>{0, 2});
  s.share.receive.assign(std::vector<Index>{1});
  std::vector<Real> motion(24);
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i] = Real(i);
  s.nodes.motion.assign(motion);
  other.rows = {-1, -2, -3, -4, -5, -6};
  receive_ghosts(s);
  CHECK(other.learned == std::vector<Real>{0, 1, 2, 4, 5, 6, 16, 17, 18, 20, 21, 22});
  const std::vector<Real> now = fetch(s.nodes.motion);
  CHECK(std::vector<Real>(now.begin() + 8, now.begin() + 16) ==
        std::vector<Real>{-1, -2, -3, 11, -4, -5, -6, 15});
  CHECK(now[0] == 0);
  CHECK(now[16] == 16);
}

TEST_CASE("sums and largest values are of the items that count") {
  Column<Real> numbers;
  numbers.assign(std::vector<Real>{1, 2, 4, 8});
  Column<Flag> own;
  own.assign(std::vector<Flag>{1, 0, 1, 0});
  CHECK(column_sum({}, numbers, {}) == 15);
  CHECK(column_sum({}, numbers, {own.data(), nullptr}) == 5);
  CHECK(most({}, 4, EachNumber<>{numbers.data()}, nullptr).item == 3);
  CHECK(most({}, 4, EachNumber<>{numbers.data()}, own.data()).item == 2);
  Pair other;  // has the same digits as nothing
  CHECK(column_sum({}, Column<Real>(), {nullptr, &other}) == 0);
}

TEST_CASE("kinds count by their flags, of a rank") {
  State s;
  s.share.own["nodes"].assign(std::vector<Flag>{1, 0});
  CHECK(s.share.counted("nodes").own == nullptr);
  Pair other;
  s.share.exchange = &other;
  CHECK(fetch(s.share.own["nodes"])[1] == 0);
  CHECK(s.share.counted("nodes").own == s.share.own["nodes"].data());
  CHECK(s.share.counted("nodes").ranks == &other);
  CHECK(s.share.counted("edges").own == nullptr);
}

TEST_CASE("numbers of a rank are told as those of the whole model") {
  State s;
  CHECK(whole_node(s, 1) == 1);
  s.share.node.assign(std::vector<Index>{3, 9});
  s.share.face.assign(std::vector<Index>{4});
  CHECK(whole_node(s, 1) == 9);
  CHECK(whole_node(s, -1) == -1);
  CHECK(whole_face(s, 0) == 4);
}

}  // namespace cdem::test
