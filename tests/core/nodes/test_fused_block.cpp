// Single-element blocks: force and motion in one kernel give the bits of the separate ones.
#include "core/nodes/fused_block.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Tets that fly, a cluster of them bonded.
struct Swarm : Scene {
  explicit Swarm(bool lumped = false) {
    Random random(1);
    bonded = true;
    // a box of six tets around its diagonal
    const std::array<Vec, 8> x = Reference<Hex8>::corners();
    const Index ring[] = {1, 2, 3, 7, 4, 5};
    for (Index k = 0; k < 6; ++k) {
      std::array<Vec, 4> tet{x[0], x[6], x[ring[k]], x[ring[(k + 1) % 6]]};
      if (dot(cross(tet[1] - tet[0], tet[2] - tet[0]), tet[3] - tet[0]) < 0)
        std::swap(tet[2], tet[3]);
      add<Tet4>(tet);
    }
    for (Index b = 0; b < 3 * block_size - 5; ++b) add_tet(random, {10.0 + 5 * b, 0, 0}, 1);
    build();
    set_interface({{"cohesion", 1e9}, {"tensile_strength", 1e9}, {"friction_angle", 0.5}});
    model.gravity = {0, 0, -9.81};
    model.lumped = lumped;
    for (Index b = 0; b < 3 * block_size + 1; ++b)
      set_motion(b, random.vector(0.1), random.vector(0.1));
    start();
  }
};

}  // namespace

void check_same_bits(Swarm& fused, Swarm& apart) {
  fused.step(50);
  CHECK(fused.state.nodes.fused.size() > 0);
  for (int n = 0; n < 50; ++n) apart.step(1);  // the first step of a run computes all
  REQUIRE(apart.state.time == fused.state.time);
  for (std::size_t k = 0; k < fused.state.nodes.motion.size(); ++k)
    if (k % 8 != 3 && k % 8 != 7)
      CHECK(same_bits(on_host(fused.state.nodes.motion)[k], on_host(apart.state.nodes.motion)[k]));
  for (Index i = 0; i < fused.model.node_count; ++i)
    CHECK(same_bits(on_host(fused.state.nodes.work_external)[i],
                    on_host(apart.state.nodes.work_external)[i]));
}

TEST_CASE("fused or not, blocks move by the same bits") {
  Swarm fused, apart;
  check_same_bits(fused, apart);
  CHECK(fused.state.tet4.fused.blocks.size() >= 3);
  CHECK(fused.state.tet4.fused.lumped.size() == 0);
}

TEST_CASE("fused or not, blocks with lumped masses move by the same bits") {
  Swarm fused(true), apart(true);
  check_same_bits(fused, apart);
  CHECK(fused.state.tet4.fused.lumped.size() >= 3);
  CHECK(fused.state.tet4.fused.blocks.size() == 0);
}

TEST_CASE("rows of a fused block begin at the place of its element") {
  const Index first[] = {0, 64, 64, 192};
  const std::vector<Index> row(192);
  const FusedRows rows{first, row.data()};
  CHECK(rows.begin(3) == 3);
  CHECK(rows.begin(block_size + 2) == 64 + 2);
  CHECK(rows.most(0, 4) == 2);
  CHECK(rows.most(block_size, 4) == 0);
  CHECK(rows.most(2 * block_size + 5, 4) == 4);
}

}  // namespace cdem::test
