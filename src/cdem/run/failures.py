"""Messages for a run that cannot continue, or with untrustworthy results."""

from __future__ import annotations

from cdem.run.law_fields import STRAIN_THAT_ENDS, large_strains
from cdem.run.state import RunState


def of_energy(run: RunState) -> str:
    """Message for an energy balance that does not close; empty if it closes."""
    error, limit = run.energies["error"], run.case.time.energy_error
    if limit == "any" or abs(error) <= limit:
        return ""
    return (
        f"the energy balance is off by {100 * error:.3g} % of its largest term, more than "
        f"time.energy_error allows ({100 * limit:.3g} %): the results cannot be trusted. "
        f"Use a smaller {_smaller(run)}; time.energy_error: any switches this check off."
    )


def of_strain(run: RunState) -> str:
    """Message for a plastic strain beyond the validity of the stress; empty if none."""
    for strain in large_strains(run):
        if strain.value > STRAIN_THAT_ENDS:
            return f"{strain.text()}; a run ends above {STRAIN_THAT_ENDS:g}"
    return ""


def of_outcome(run: RunState, outcome: str, culprit: int, value: float) -> str:
    """Message for a failed outcome of the core.

    Args:
        run: The run.
        outcome: Name of the outcome in the core.
        culprit: Number of the exposed face for "lost_contact", else of the node.
        value: Number of missed contacts, or a speed [m/s].
    """
    if outcome == "missed_contact":
        return (
            f"the all-pairs search of contact.check found {int(value)} contact(s) missing from the "
            f"lists."
            " Please report this case."
        )
    topology = run.build.topology
    if outcome == "lost_contact":
        block = int(topology.face_block[int(run.core.fields()["search.exposed_face"][culprit])])
        return (
            f"a loaded contact of block {block} (group {_group(run, block)}) penetrated too deeply "
            f"to be "
            "tracked. Raise contact_stiffness of its interface, or lower the impact speed."
        )
    block = int(topology.node_block[culprit])
    group = _group(run, block)
    where = f"node {culprit} of block {block} (group {group})"
    dt = float(run.core.scalars()["dt"])
    if outcome == "not_finite":
        return (
            f"{where} no longer has a finite position or velocity; dt = {dt:.3g} s. "
            f"Use a smaller {_smaller(run)}, or look for a bad element there."
        )
    if block in run.fallen and any(d.group == group for d in run.departures):
        return (
            f"{where} fell past the edge of the model and now falls at {value:.3g} m/s, "
            "faster than the P wave of the rock. Make the ground larger, end the stage before that "
            "(until: rest), or let model.domain remove such blocks."
        )
    return (
        f"{where} moves at {value:.3g} m/s, faster than the P wave of the rock; "
        f"dt = {dt:.3g} s. Use a smaller {_smaller(run)}, or a lower stiffness_n or contact_stiffness."
    )


def _group(run: RunState, block: int) -> str:
    return run.build.group_names[run.build.topology.block_group[block]]


def _smaller(run: RunState) -> str:
    """The key of a case that reduces the step."""
    return "time.safety" if run.case.time.step == "auto" else "time.step"
