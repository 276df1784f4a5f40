"""Why a run ends that cannot go on, or whose results are not to be trusted: the words for it."""

from __future__ import annotations

from cdem.run.law_fields import STRAIN_THAT_ENDS, large_strains
from cdem.run.state import RunState


def of_energy(run: RunState) -> str:
    """An energy balance too far from closing for results to be trusted; empty while it closes."""
    error, limit = run.energies["error"], run.case.time.energy_error
    if limit == "any" or abs(error) <= limit:
        return ""
    return (
        f"the energy balance is off by {100 * error:.3g} % of its largest term, more than "
        f"time.energy_error allows ({100 * limit:.3g} %), so that the results are not to be "
        f"trusted. Use a smaller {_smaller(run)}; time.energy_error: any goes on whatever it is."
    )


def of_strain(run: RunState) -> str:
    """Rock that flows further than its stress is right; empty where none does."""
    for strain in large_strains(run):
        if strain.value > STRAIN_THAT_ENDS:
            return f"{strain.text()}; above {STRAIN_THAT_ENDS:g} a run ends"
    return ""


def of_outcome(run: RunState, outcome: str, culprit: int, value: float) -> str:
    """What an outcome of the core means that is none of a sound run.

    Args:
        run: The run.
        outcome: Its name in the core.
        culprit: Number of the exposed face of "lost_contact"; of the node of the others.
        value: Contacts that were missed, or a speed [m/s].
    """
    if outcome == "missed_contact":
        return (
            f"the all-pairs search of contact.check found {int(value)} contact(s) that the lists had "
            "missed. Please report this case."
        )
    topology = run.build.topology
    if outcome == "lost_contact":
        block = int(topology.face_block[int(run.core.fields()["search.exposed_face"][culprit])])
        return (
            f"a loaded contact of block {block} (group {_group(run, block)}) penetrated too deep to be "
            "followed. Raise contact_stiffness of its interface, or lower the impact speed."
        )
    block = int(topology.node_block[culprit])
    group = _group(run, block)
    where = f"node {culprit} of block {block} (group {group})"
    dt = float(run.core.scalars()["dt"])
    if outcome == "not_finite":
        return (
            f"{where} has no finite position or velocity any more; dt = {dt:.3g} s. "
            f"Use a smaller {_smaller(run)}, or look for a bad element there."
        )
    if block in run.fallen and any(d.group == group for d in run.departures):
        return (
            f"{where} fell past the edge of the model and now falls at {value:.3g} m/s, "
            "faster than the P wave of the rock. Make the ground larger, end the stage before that "
            "(until: rest), or let model.domain take such blocks out."
        )
    return (
        f"{where} moves at {value:.3g} m/s, faster than the P wave of the rock; "
        f"dt = {dt:.3g} s. Use a smaller {_smaller(run)}, or a lower stiffness_n or contact_stiffness."
    )


def _group(run: RunState, block: int) -> str:
    return run.build.group_names[run.build.topology.block_group[block]]


def _smaller(run: RunState) -> str:
    """The key of a case that makes the step smaller."""
    return "time.safety" if run.case.time.step == "auto" else "time.step"
