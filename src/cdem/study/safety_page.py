"""One page about a factor of safety, for a client: answer, body that fails, model, trials."""

from __future__ import annotations

import base64
import io
import json
import time
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment
from numpy.typing import NDArray

from cdem._version import __version__
from cdem.case.case import Case
from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS
from cdem.case.types import Part
from cdem.model.interfaces import name_of
from cdem.study.critical import Critical, FactorOfSafety
from cdem.whole_files import write_text

KEPT = "kept as joints slip"
WRITTEN = "as the laws are written"


def write_safety_page(
    path: Path, case: Case, found: FactorOfSafety, image: NDArray[np.uint8] | None
) -> None:
    """Write the page: one HTML file without scripts, which loads nothing.

    Args:
        path: The file.
        case: The case, as given.
        found: Its factors of safety.
        image: Picture of the failed model, shape (height, width, 3), or None.

    Raises:
        DiskError: The file cannot be written.
    """
    text = (resources.files("cdem.study") / "safety_page.html").read_text(encoding="utf-8")
    page = Environment(autoescape=True, trim_blocks=True).from_string(text)
    audit = found.kept.audit
    assert audit is not None  # a search leaves it
    html = page.render(
        title=case.title or path.stem,
        file=Path(case._source.file or path.stem).name,
        version=__version__,
        date=time.strftime("%Y-%m-%d"),
        factors=list(_factors(found)),
        picture=_packed(image),
        strengths=list(_strengths(case)),
        actions=list(_actions(case)),
        criterion=found.kept.criterion.text(),
        warnings=audit.warnings + _cautions(found),
        model=audit.text(),
    )
    write_text(path, html)


def _cautions(found: FactorOfSafety) -> list[str]:
    both = ((KEPT, found.kept), (WRITTEN, found.written))
    return [f"{name}: {text}" for name, one in both if one and (text := one.caution())]


def _factors(found: FactorOfSafety) -> Any:
    same = "" if found.may_lose else ", no law as written loses strength"
    yield _factor(KEPT, "as in limit equilibrium" + same, found.kept)
    if found.written:
        lose = ", ".join(found.may_lose)
        yield _factor(WRITTEN, f"progressive failure: {lose} may lose strength", found.written)


def _factor(name: str, meaning: str, found: Critical) -> dict[str, Any]:
    failed = found.trial_that_failed
    broken = [f"{100 * part:.2g} % of {where}" for where, part in found.broken.items() if part]
    digits = max(2, int(np.ceil(-np.log10(abs(found.failed - found.stable)))))
    return {
        "name": name,
        "meaning": meaning,
        "value": f"{found.value:.{digits}f}",
        "stable": f"{found.stable:.4g}",
        "failed": f"{found.failed:.4g}",
        "bodies": [body.text() for body in failed.bodies],
        "chips": "; ".join(body.text() for body in failed.chips),
        "why": f"{failed.saw}: {failed.why}",
        "broken": ", ".join(broken),
        "trials": [
            (f"{t.value:.4g}", "rests" if t.stable else f"fails, {t.saw}", f"{t.steps:,}", t.why)
            for t in found.trials
        ],
    }


def _packed(image: NDArray[np.uint8] | None) -> str:
    if image is None:
        return ""
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(image).save(file, "png")
    return base64.b64encode(file.getvalue()).decode()


def _strengths(case: Case) -> Any:
    """Name, law and values of interfaces and materials, after the settings of all stages."""
    last = case.model_copy(deep=True)
    for stage in case.stages:
        for key, value in stage.set.items():
            last.set(key, value)
    default = [last.interfaces.default] if last.interfaces.default else []
    for interface in [*last.interfaces.pairs, *default]:
        yield name_of(interface), interface.law, _values(INTERFACE_LAWS, interface)
    for name, material in last.materials.items():
        more = f"density {material.density:g} kg/m3, E {material.young_modulus:.4g} Pa, "
        more += f"nu {material.poisson_ratio:g}"
        values = _values(BLOCK_LAWS, material)
        yield name, material.law, f"{more}; {values}" if values else more


def _values(laws: Any, part: Part) -> str:
    law = laws[part.__dict__["law"]]
    given = ((p, getattr(part, p.name)) for p in law.parameters)
    return ", ".join(
        f"{p.name} {value if isinstance(value, str) else format(value, '.4g')} {p.unit}".rstrip()
        for p, value in given
        if value is not None
    )


def _actions(case: Case) -> Any:
    """Loads, supports, water and bolts, as the case has them."""
    for part, name in ((case.loads, "loads"), (case.water, "water")):
        for key, value in part.model_dump(mode="json", exclude_unset=True).items() if part else ():
            entries = value if isinstance(value, list) and name + key != "loadsgravity" else [value]
            for entry in entries:
                yield f"{name}.{key}: {_plain(entry)}"
    for bolts in case.bolts:
        yield f"bolts: {_plain(bolts.model_dump(mode='json', exclude_unset=True))}"
    for name, group in case.groups.items():
        if group.fix:
            yield f"group {name}: fixed in {', '.join(group.fix)}"


def _plain(entry: Any) -> str:
    """A part of a case on one line, without quotes around its names."""
    return json.dumps(entry).replace('"', "")
