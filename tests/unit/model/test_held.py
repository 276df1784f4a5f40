"""Blocks that nothing holds."""

from scenes import simulate

from cdem.model.held import unheld_blocks


def test_a_block_is_held_directly_or_through_others():
    """One on the bed, one on that, one above a gap; nothing holds the first two without the bed."""
    heights = {"low": 0.0, "high": 0.5, "loose": 3.0}
    blocks = [{"group": "bed", "box": {"size": [4, 4, 1]}, "translate": [-1, -1, -1]}]
    blocks += [
        {"group": name, "box": {"size": [1, 1, 0.5]}, "translate": [0, 0, z]}
        for name, z in heights.items()
    ]
    sim = simulate(blocks, {"bed": {"fix": ["x", "y", "z"]}} | {name: {} for name in heights})
    group, names = sim.build.topology.block_group, sim.build.group_names

    def unheld(out):
        found = unheld_blocks(sim.build, group == names.index(out) if out else group < 0)
        return {names[g] for g in group[found]}

    assert unheld(None) == {"loose"}
    assert unheld("bed") == {"low", "high", "loose"}
    assert unheld("loose") == set()
