// ranks.hpp - the part of a model that a rank has, from Python.
#pragma once

#include <memory>

#include "bindings/arrays.hpp"
#include "core/contact/broad_phase/near_boxes.hpp"

namespace cdem {

/// Ranks that talk through an object of Python, see cdem.ranks.exchange.
class PythonExchange : public Exchange {
 public:
  explicit PythonExchange(nb::object ranks)
      : ranks_(std::move(ranks)), count_(nb::cast<int>(ranks_.attr("count"))) {}

  int count() const override { return count_; }
  void add_up(std::int64_t* words, Index count) override {
    const nb::gil_scoped_acquire held;
    ranks_.attr("add_up")(view(words, count));
  }
  void gather(const void* own, std::size_t bytes, void* all) override {
    const nb::gil_scoped_acquire held;
    ranks_.attr("gather")(view(static_cast<const std::uint8_t*>(own), bytes),
                          view(static_cast<std::uint8_t*>(all), bytes * count_));
  }
  void swap(const Real* send, Index sent, Real* receive, Index received, Index numbers) override {
    const nb::gil_scoped_acquire held;
    ranks_.attr("swap")(view(send, std::size_t(sent) * numbers),
                        view(receive, std::size_t(received) * numbers), numbers);
  }

 private:
  /// An array of Python on our memory, while it is called.
  template <class T>
  static nb::object view(T* numbers, std::size_t size) {
    const nb::ndarray<nb::numpy, T> array(numbers, 1, &size, nb::handle());
    return nb::cast(array, nb::rv_policy::reference);
  }

  nb::object ranks_;
  int count_;
};

/// Take the settings of another core, as they are now, and the interfaces.
inline void take_settings(Core& core, const Core& whole) {
  static_cast<Settings&>(core.model) = whole.model;
  core.state.nodes.keeps_peaks = whole.state.nodes.keeps_peaks;
  core.model.interfaces.assign(fetch(whole.model.interfaces));
  core.model.interface_parameters.assign(fetch(whole.model.interface_parameters));
}

/// Make the core the part of a rank: arrays by name as in Share, those by kind of rows in dicts.
inline void take_share(Core& core, nb::object exchange, const nb::dict& from) {
  Share& share = core.state.share;
  core.exchange = std::make_unique<PythonExchange>(std::move(exchange));
  share.exchange = core.exchange.get();
  const auto each = [&](const char* name, auto& into) {
    into.clear();
    for (const auto& [kind, array] : nb::cast<nb::dict>(from[name]))
      copy(array, into[nb::cast<std::string>(kind)]);
  };
  each("own", share.own);
  each("tiles", share.tiles);
  copy(from["node"], share.node);
  copy(from["face"], share.face);
  copy(from["block"], share.block);
  copy(from["cut_block"], share.cut_block);
  copy(from["send"], share.send);
  copy(from["receive"], share.receive);
  copy(from["fence"], share.fence);
  share.cut_blocks = nb::cast<Index>(from["cut_blocks"]);
}

/// See flag_near; boxes are rows of lowest and highest x y z.
inline nb::ndarray<nb::numpy, Flag> near_boxes(Array<Real> boxes, Array<Real> reach,
                                               Array<Flag> flags) {
  static_assert(sizeof(Box) == 6 * sizeof(Real));
  if (boxes.size() != 6 * flags.size() || reach.size() != flags.size())
    throw nb::value_error("a flag and a reach for each box");
  Column<Box> all;
  Column<Real> room;
  Column<Flag> near;
  all.assign(reinterpret_cast<const Box*>(boxes.data()), flags.size());
  room.assign(reach.data(), reach.size());
  near.assign(flags.data(), flags.size());
  flag_near(all, room, near);
  const auto found = on_host(near);
  return array_of(std::vector<Flag>(found.begin(), found.end()));
}

}  // namespace cdem
