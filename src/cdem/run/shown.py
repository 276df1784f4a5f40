"""Display of a run: its progress, and its state as a table in a notebook."""

from __future__ import annotations

from html import escape
from pathlib import Path

from cdem.model.ruling_step import ruling_step
from cdem.run.progress import Progress
from cdem.run.stage_state import StageState
from cdem.run.state import RunState


def progress(run: RunState, stage: StageState, speed: float, note: str) -> Progress:
    """Progress of a run.

    Args:
        run: The run.
        stage: Its running stage.
        speed: Steps per second of wall time.
        note: Advice for the user, or nothing.
    """
    end = stage.end_time
    fraction = left = None
    if end is not None:
        # a stage shorter than the time resolution ends at once
        length = end - stage.start_time
        fraction = (run.time - stage.start_time) / length if length > 0 else 1.0
        if fraction > 0:
            left = stage.wall_time * (1 - fraction) / fraction
    return Progress(
        stage=stage.name,
        time=run.time,
        end_time=end,
        step=run.step_count,
        dt=float(run.core.scalars()["dt"]),
        rules=_rules(run),
        unbalance_ratio=run.core.unbalance_ratio(),
        energy_error=run.energies["error"],
        broken=sum(run.broken.values()),
        steps_per_second=speed,
        time_left=left,
        fraction=fraction,
        note=note,
    )


def _rules(run: RunState) -> str:
    """Limit of the step, if the program chooses the step and masses are not scaled to it."""
    made = run.case.time.step != "auto" or len(run.core.fields()["node.relax_mass"])
    return "" if made else ruling_step(run.build).words()


def table(run: RunState, folder: Path | None) -> str:
    """Display in a notebook: the state of a run as a table in HTML.

    Args:
        run: The run.
        folder: Its result folder, or None.
    """
    counts, broken = run.audit.counts, run.broken
    stage = "all stages have ended" if run.is_over else run.case.stages[run.stage_index].name
    rows = {
        "stage": stage,
        "time": f"{run.time:.6g} s",
        "steps": f"{run.step_count:,}",
        "elements, blocks": f"{counts['elements']:,}, {counts['blocks']:,}",
        "springs broken in tension, shear": f"{broken['tension']:,}, {broken['shear']:,}",
    }
    if run.step_count:
        rows["energy balance closes to"] = f"{100 * run.energies['error']:.2g} %"
    if folder:
        rows["results"] = f"cdem.open({str(folder)!r})"
    lines = (f"<tr><td>{escape(k)}</td><td>{escape(v)}</td></tr>" for k, v in rows.items())
    return f"<b>{escape(run.case.title or 'Simulation')}</b><table>{''.join(lines)}</table>"
