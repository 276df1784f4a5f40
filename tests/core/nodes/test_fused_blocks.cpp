// Which blocks take the fused kernel.
#include "core/nodes/fused_blocks.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

namespace {

/// Sixteen tets far apart.
struct Tets : Scene {
  Tets() {
    Random random(1);
    for (Index b = 0; b < 2 * block_size; ++b) add_tet(random, {5.0 * b, 0, 0}, 1);
    build();
    start();
    step(1);
  }
  std::vector<Index> fused() {
    find_fused_blocks(model, state);
    const Column<Index>& list = state.tet4.fused.blocks;
    return {list.data(), list.data() + list.size()};
  }
};

}  // namespace

TEST_CASE("free blocks are fused, those with a load or a support are not") {
  Tets tets;
  CHECK(tets.fused() == std::vector<Index>{0, 1});
  const Index second = 4 * block_size;  // first node of the second block of elements
  on_host(tets.model.support)[second + 2] = 0;
  CHECK(tets.fused() == std::vector<Index>{0});
  CHECK(on_host(tets.state.nodes.fused)[0] == 1);
  CHECK(on_host(tets.state.nodes.fused)[second] == 0);
  CHECK(tets.state.nodes.general.size() == 4);  // 32 nodes of the other
  on_host(tets.model.support)[second + 2] = -1;
  for (Index i = 2; i <= tets.model.node_count; ++i) on_host(tets.model.load_first)[i] = 1;
  CHECK(tets.fused() == std::vector<Index>{1});
}

TEST_CASE("blocks with contacts, scaled masses or another formulation are not fused") {
  Tets tets;
  for (Index i = 1; i <= tets.model.node_count; ++i)
    on_host(tets.state.search.contact_first)[i] = 1;
  CHECK(tets.fused() == std::vector<Index>{1});
  tets.state.nodes.relax_mass.resize(tets.model.node_count);
  tets.fused();
  CHECK(tets.state.nodes.fused.size() == 0);
  tets.state.nodes.relax_mass.resize(0);
  tets.model.formulation = Formulation::incremental;
  tets.fused();
  CHECK(tets.state.nodes.fused.size() == 0);
}

TEST_CASE("blocks with lumped masses are fused apart, and blocks with both not at all") {
  Tets tets;
  tets.state.nodes.lumped.resize(tets.model.node_count);
  const Index second = 4 * block_size;
  for (Index i = second; i < tets.model.node_count; ++i) on_host(tets.state.nodes.lumped)[i] = 1;
  CHECK(tets.fused() == std::vector<Index>{0});
  CHECK(tets.state.tet4.fused.lumped.size() == 1);
  CHECK(on_host(tets.state.tet4.fused.lumped)[0] == 1);
  CHECK(on_host(tets.state.nodes.fused)[second] == 1);
  for (Index i = 0; i < 4; ++i) on_host(tets.state.nodes.lumped)[second + i] = 0;
  CHECK(tets.fused() == std::vector<Index>{0});
  CHECK(tets.state.tet4.fused.lumped.size() == 0);
  CHECK(tets.state.tet4.fused.general.size() == 1);
}

}  // namespace cdem::test
