// bounding_boxes.cpp - see bounding_boxes.hpp.
#include "core/contact/broad_phase/bounding_boxes.hpp"

#include "core/base/primitives.hpp"

namespace cdem {

void BoxTreeColumns::make(Queue q, const Column<Box>& boxes) {
  const Index count = Index(boxes.size());
  const auto groups_of = [](Index items) { return (items + BoxGroup::fan - 1) / BoxGroup::fan; };
  levels_ = 0;
  Index groups = 0;
  for (Index below = count; below > 0; below = groups_of(below) > 1 ? groups_of(below) : 0) {
    level_first_[levels_++] = groups;
    groups += groups_of(below);
  }
  groups_.renew(groups);
  order_.renew(count);
  codes_.renew(count);
  if (count == 0) return;
  const auto group = [&](const Index* order) {
    for_each_item(
        q, groups_of(count),
        GroupBoxes{
            .count = count, .order = order, .boxes = boxes.data(), .groups = groups_.data()});
    for (Index level = 1; level < levels_; ++level) {
      const Index below = level_first_[level] - level_first_[level - 1];
      for_each_item(q, groups_of(below),
                    GroupGroups{below, groups_.data() + level_first_[level - 1],
                                groups_.data() + level_first_[level]});
    }
  };
  group(nullptr);  // for the box that holds all
  for_each_item(q, count,
                FindMortonCodes{.boxes = boxes.data(),
                                .all = groups_.data() + groups - 1,
                                .order = order_.data(),
                                .codes = codes_.data()});
  sort_pairs(q, count, codes_.data(), order_.data());
  group(order_.data());
}

BoxTree BoxTreeColumns::tree() const {
  BoxTree tree{
      .order = order_.data(), .groups = groups_.data(), .level_first = {}, .levels = levels_};
  for (Index level = 0; level < levels_; ++level) tree.level_first[level] = level_first_[level];
  return tree;
}

}  // namespace cdem
