// ranks.cpp - see ranks.hpp.
#include "core/ranks/ranks.hpp"

#include "core/base/parallel.hpp"
#include "core/model/phase_timer.hpp"

namespace cdem {

bool any_rank(const State& s, bool own) {
  if (!s.share.exchange) return own;
  std::int64_t holds = own ? 1 : 0;
  s.share.exchange->add_up(&holds, 1);
  return holds > 0;
}

void to_ghosts(State& s, Real* rows, const SentNumbers& numbers) {
  Share& share = s.share;
  if (!share.exchange) return;
  const Index sent = Index(share.send.size()), received = Index(share.receive.size());
  share.out.renew(std::size_t(sent) * numbers.count);
  share.in.renew(std::size_t(received) * numbers.count);
  for_each_item({}, sent,
                PackRows{.numbers = numbers,
                         .nodes = share.send.data(),
                         .rows = rows,
                         .message = share.out.data()});
  finish({});
  {
    const Transfer transfer;
    share.exchange->swap(share.out.data(), sent, share.in.data(), received, numbers.count);
  }
  for_each_item({}, received,
                UnpackRows{.numbers = numbers,
                           .nodes = share.receive.data(),
                           .message = share.in.data(),
                           .rows = rows});
}

void receive_ghosts(State& s) {
  if (!s.share.exchange) return;
  const PhaseTimer timer(s, Phase::node);
  to_ghosts(s, s.nodes.motion.data(), SentNumbers::motion());
}

namespace {

Index whole(const Column<Index>& numbers, Index own) {
  return own < 0 || numbers.size() == 0 ? own : on_host(numbers)[own];
}

}  // namespace

Index whole_node(const State& s, Index node) { return whole(s.share.node, node); }
Index whole_face(const State& s, Index face) { return whole(s.share.face, face); }

}  // namespace cdem
