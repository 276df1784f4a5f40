// Forces of columns on the nodes of sides.
#include <vector>

#include "core/columns/side.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

TEST_CASE("a side node gets the stress of its layers, and the dashpots that its level moves") {
  const std::vector<Real> layers{2, 12, 4, 6, 1, 10, 2, 3, 1, 1, 0, 0};
  const std::vector<Real> displacement{0, 0, 0, 0, 4, 1, -1, 0, 5, 2, 0, 0};
  const std::vector<Real> before{0, 0, 0, 0, 1, 2, 3, 0, 3, 0, 1, 0};
  std::vector<Real> after{0, 0, 0, 0, 3, 2, 1, 0, 5, 0, 3, 0};
  const std::vector<Index> layer_first{0, 2}, layer{0, 1}, level{1};
  const std::vector<Real> area{0.5, 0, 0, 0, 0, -0.25, 0, 0}, part{0.5};
  const std::vector<Real> dashpot{1, 2, 3, 0.5, 0, 0, 0, 0};
  const std::vector<Flag> bond(3);
  std::vector<Real> out(4);
  auto* displaced = const_cast<Real*>(displacement.data());
  auto* earlier = const_cast<Real*>(before.data());
  const Layers ground{.rows = layers.data(),
                      .bond = bond.data(),
                      .rock_time = 0,
                      .bond_time = 0,
                      .maxwell = {},
                      .motion = {displaced, earlier, after.data(), nullptr}};
  SideForces{.layer_first = layer_first.data(),
             .layer = layer.data(),
             .area = area.data(),
             .level = level.data(),
             .part = part.data(),
             .dashpot = dashpot.data(),
             .layers = ground,
             .out = {out.data()}}(One{0});
  // mean velocity half way between levels 1 and 2: ((2, 2, 2) + (4, 0, 2)) / 2 = (3, 1, 2)
  const Vec drag{1 * 3 + 0.5 * 1, 0.5 * 3 + 2 * 1, 3 * 2};
  // layer 0: shear (12, 3), normal -6, beside 4/12 * -6 = -2; layer 1: shear (3, 3), normal 10, 2
  const Vec stress{-2 * 0.5, 2 * -0.25, 12 * 0.5 + 3 * -0.25};
  CHECK(norm(vector_at(out.data()) - (drag + stress)) < 1e-14);
}

}  // namespace cdem::test
