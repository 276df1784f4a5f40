// near_boxes.cpp - see near_boxes.hpp.
#include "core/contact/broad_phase/near_boxes.hpp"

#include <vector>

#include "core/base/parallel.hpp"

namespace cdem {

void flag_near(const Column<Box>& boxes, Column<Flag>& flags) {
  const Transfer transfer;
  std::vector<Box> flagged;
  const auto all = on_host(boxes);
  const auto flag = on_host(flags);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (flag[i]) flagged.push_back(all[i]);
  Column<Box> others;
  others.assign(flagged);
  BoxTreeColumns tree;
  tree.make({}, others);
  for_each_item({}, Index(boxes.size()), FlagNear{boxes.data(), tree.tree(), flags.data()});
  finish({});
}

}  // namespace cdem
