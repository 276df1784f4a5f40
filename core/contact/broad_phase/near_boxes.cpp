// near_boxes.cpp - see near_boxes.hpp.
#include "core/contact/broad_phase/near_boxes.hpp"

#include <vector>

#include "core/base/parallel.hpp"

namespace cdem {

void flag_near(const Column<Box>& boxes, const Column<Real>& reach, Column<Flag>& flags) {
  const Transfer transfer;
  std::vector<Box> flagged;
  std::vector<Index> numbers;
  const auto all = on_host(boxes);
  const auto room = on_host(reach);
  const auto flag = on_host(flags);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (flag[i]) {
      numbers.push_back(Index(i));
      flagged.push_back(all[i]);
      flagged.back().inflate(room[i]);
    }
  Column<Box> others;
  Column<Index> number;
  others.assign(flagged);
  number.assign(numbers);
  BoxTreeColumns tree;
  tree.make({}, others);
  for_each_item({}, Index(boxes.size()),
                FlagNear{.boxes = boxes.data(),
                         .reach = reach.data(),
                         .tree = tree.tree(),
                         .others = number.data(),
                         .flags = flags.data()});
  finish({});
}

}  // namespace cdem
