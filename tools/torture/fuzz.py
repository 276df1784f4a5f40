"""Feed mutated files to every reader: `fuzz.py cases 20000 --seed 1`, `fuzz.py files 10000`.

First come the inputs of the corpus, which once failed. Each other input is made from the seed and
its number alone. A batch runs in a process of its own; one that dies or hangs is counted, and the
next begins behind it. An input that fails is kept in the corpus, where `git add tests/corpus` makes
it part of the tests; why it failed is kept in the folder after `--out`. Prints a line of counts, and
ends with status 1 if anything failed.
"""

from __future__ import annotations

import argparse
import gzip
import io
import os
import queue
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import corpus as parts
import mutations
from state import State, add_option

CORPUS = Path(__file__).parents[2] / "tests/corpus"
SLOW = 5.0
"""Seconds of processor time above which an input counts as a hang."""
SILENT = 30.0
"""Wall seconds without a word after which a process is killed."""
START = 120.0
"""Wall seconds in which a process must begin."""
BATCH = 500
MOST_MEMORY = 1000
"""Peak of a process that is allowed [MB]."""
ASIDE = (
    ".vtk", ".vtu", ".med", ".h5m", ".cgns", ".hmf", ".xdmf", ".tif", ".vrt", ".grd", ".gpkg",
    ".shp", ".kml", ".kmz", ".fgb", ".dxf", ".laz",
)  # fmt: skip
"""Formats that are often read in a process of their own."""
SMALL = 300
"""Elements up to which a model is built."""


# ------------------------------------------------------------------ inputs


def make_case(rng: random.Random, path: Path, seeds: list[Path]) -> tuple[str, bytes]:
    """A mutated case, study or landslide file: its name, and its bytes."""
    text = path.read_text()
    if rng.random() < 0.6:
        from ruamel.yaml import YAML

        yaml, out = YAML(typ="safe", pure=True), io.StringIO()
        tree = yaml.load(text)
        for _ in range(rng.choice((1, 1, 1, 2, 4))):
            change = rng.choice((mutations.scale_number, mutations.mutate_tree, mutations.graft))
            if change is mutations.graft:
                tree = mutations.graft(rng, tree, yaml.load(rng.choice(seeds).read_text()))
            elif tree:
                tree = change(rng, tree)
        yaml.sort_base_mapping_type_on_output = False
        yaml.dump(tree, out)
        text = out.getvalue()
    else:
        for _ in range(rng.choice((1, 1, 2, 4))):
            text = mutations.mutate_text(rng, text)
    return path.name, mutations.encode(rng, text)


def make_file(rng: random.Random, path: Path, _: list[Path]) -> tuple[str, bytes]:
    """A mutated mesh, body or terrain file: its name, and its bytes."""
    raw, name = path.read_bytes(), path.name
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        raw = mutations.mutate_bytes(rng, raw)
    if name.startswith("mesh-") and rng.random() < 0.03:
        raw, name = gzip.compress(raw, mtime=0), name + ".gz"
        raw = mutations.mutate_bytes(rng, raw) if rng.random() < 0.5 else raw
    return name, raw


def make(kind: str, seed: int, number: int, seeds: list[Path]) -> tuple[str, bytes]:
    """Input of a number, the same in every process."""
    rng = random.Random(f"{kind} {seed} {number}")
    path = rng.choice(seeds)
    if path.suffix in ASIDE and rng.random() < 0.7:  # a process for each takes a second
        path = rng.choice(seeds)
    return (make_case if kind == "cases" else make_file)(rng, path, seeds)


# ------------------------------------------------------------------ what is done with one


def read_case(path: Path) -> None:
    """Read a case, or a file beside it; build the model of a case if it is small."""
    from cdem.case.case import Case
    from cdem.fit.fitting import Fit
    from cdem.rockfall import run as rockfall
    from cdem.rockfall.rockfall import Rockfall
    from cdem.run.simulation import Simulation
    from cdem.screening.loads import Loads
    from cdem.screening.planes import read_planes
    from cdem.screening.uncertain import Uncertain
    from cdem.study.plan import plan
    from cdem.study.schema import run_count
    from cdem.study.study import Study
    from cdem.terrain.landslide import Landslide

    seed = path.with_name(path.name.replace("-now-", "-"))  # none for an input of the corpus
    sound = (seed if seed.exists() else path).read_text(errors="replace")
    if "\nuncertain:" in sound:
        chances = Uncertain.load(path)
        chances.for_sets(read_planes(path.with_name("screening-joints.yaml"))[0], Loads())
        chances.draw()
        return
    if "\nrockfall:" in sound:
        given = Rockfall.load(path)
        if given.count <= 1000:
            rockfall.plan(given, path.parent)
        return
    if "\nobserved:" in sound:
        Fit.load(path).load_study()
        return
    if "\nparameters:" in sound:
        study = Study.load(path)
        if run_count(study) <= 20:
            plan(study, path.parent)
        return
    if "\nextent:" in sound:
        Landslide.load(path)
        return
    case = Case.load(path)
    if _is_small(case):
        audit = Simulation(case, threads=1).audit
        audit.as_dict()
        audit.text()


def _is_small(case: Any) -> bool:
    boxes = [b.box for b in case.model.blocks if b.box is not None]
    elements = sum(6 * b.divisions[0] * b.divisions[1] * b.divisions[2] for b in boxes)
    mesh = case.model.mesh and case.path_of(case.model.mesh)
    large = mesh and mesh.stat().st_size > 50_000
    if large or elements > SMALL:
        return False
    return not case.model.joints or (elements <= SMALL // 10 and _few_planes(case, boxes))


def _few_planes(case: Any, boxes: list[Any]) -> bool:
    """Whether the joints of a case are some dozens of planes."""
    joints, bodies = case.model.joints, [*case.model.blocks, case.model]
    lengths = [x for box in boxes for x in box.size]
    solids = [b.polyhedron.vertices for b in case.model.blocks if b.polyhedron is not None]
    lengths += [max(x) - min(x) for corners in solids for x in zip(*corners, strict=True)]
    lengths += [abs(x) for body in bodies for x in body.translate or []]
    lengths += [abs(x) for joint in joints for x in joint.origin]
    near = all(j.spacing is None or 8 * j.spacing > max(lengths) for j in joints)
    return len(joints) <= 3 and near


def read_file(path: Path) -> None:
    """Read a file by the first part of its name, and do what follows first."""
    import numpy as np

    from cdem.case.history_file import with_histories
    from cdem.case.record_file import read_series
    from cdem.case.source import Source
    from cdem.case.waves_schema import Record
    from cdem.fit.monitored import read_monitored
    from cdem.joints.measured import read_measured
    from cdem.mesh.blocks import build_topology
    from cdem.mesh.mesh_files import read_mesh
    from cdem.model.body_files import read_bodies
    from cdem.outcrop.cloud_files import read_outcrop
    from cdem.terrain.clouds import read_cloud
    from cdem.terrain.facet_files import read_facets
    from cdem.terrain.files import read_lines, read_outline
    from cdem.terrain.heights import Lines
    from cdem.terrain.projection import Projection
    from cdem.terrain.rasters import read_grid
    from cdem.terrain.triangles import Triangles

    kind = path.name.split("-")[0]
    if kind == "mesh":
        build_topology(read_mesh(path), {})
    elif kind == "body":
        build_topology(read_bodies(path, "rock"), {})
    elif kind == "lines":
        Lines(read_lines(path), 5.0)
    elif kind == "grid":
        read_grid(path)
    elif kind == "facets":
        found = read_facets(path, "A" if path.suffix == ".dxf" else None)
        Triangles(found.points, found.triangles, found.rounding)(np.full((1, 2), 5.0))
    elif kind == "history":
        with_histories({"history": {"file": path.name}}, Source(file=str(path)))
    elif kind == "record":
        series = read_series(path)
        Record(
            samples=series.samples.tolist(), unit=series.unit or "g", step=series.step or 0.01
        ).steps()
    elif kind == "outcrop":
        read_outcrop(path)
    elif kind == "joints":
        read_measured(path)
    elif kind == "monitored":
        read_monitored(path)
    elif kind == "cloud":
        box = np.zeros(2), np.full(2, 9.0)
        read_cloud(path, Projection(None), None, box, 1.0, "ground")
    else:
        read_outline(path)


def work(kind: str, seed: int | None, first: int, count: int, folder: Path, corpus: Path) -> None:
    """Feed a batch of inputs, and say of each what came of it; without a seed those of the corpus."""
    words = os.fdopen(os.dup(1), "w")
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    from cdem.errors import CdemError

    read: Callable[[Path], None] = read_case if kind == "cases" else read_file
    seeds = seeds_of(folder / "seeds")
    for number in range(first, first + count):
        name, raw = given(kind, seed, number, seeds, corpus)
        path = folder / "seeds" / f"{name.split('-')[0]}-now-{name.partition('-')[2]}"
        path.write_bytes(raw)
        print(f"begin {number}", file=words, flush=True)
        began, what = spent(), "read"
        try:
            read(path)
        except CdemError as error:
            what = "refused" if str(error) else "nameless"
        except BaseException:
            what = "traceback"
            keep(folder, corpus, number, seed, name, raw, traceback.format_exc())
        seconds = spent() - began
        path.unlink()
        if seconds > SLOW:
            what = "hang"
            keep(folder, corpus, number, seed, name, raw, f"{seconds:.1f} s")
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1000
        print(f"end {number} {what} {seconds:.3f} {memory}", file=words, flush=True)


def spent() -> float:
    """Processor time of this process and of those that it has waited for [s]."""
    t = os.times()
    return t.user + t.system + t.children_user + t.children_system


def seeds_of(folder: Path) -> list[Path]:
    """Files to start from."""
    return [p for p in sorted(folder.iterdir()) if "-" in p.name and "-now-" not in p.name]


def kept(corpus: Path) -> list[Path]:
    """Inputs of a corpus."""
    return sorted(corpus.glob("*-*"))


def given(
    kind: str, seed: int | None, number: int, seeds: list[Path], corpus: Path
) -> tuple[str, bytes]:
    """Input of a number, made from a seed, or without one that of the corpus."""
    if seed is not None:
        return make(kind, seed, number, seeds)
    path = kept(corpus)[number]
    return path.name, path.read_bytes()


def keep(
    folder: Path, corpus: Path, number: int, seed: int | None, name: str, raw: bytes, why: str
) -> None:
    """Keep an input that failed in the corpus, and what happened in the folder."""
    if seed is not None:
        corpus.mkdir(parents=True, exist_ok=True)
        first, _, rest = name.partition("-")
        name = f"{first}-{seed}_{number}-{rest}"
        (corpus / name).write_bytes(raw)
    failed = folder / "failed"
    failed.mkdir(exist_ok=True)
    (failed / f"{name}.txt").write_text(why)


# ------------------------------------------------------------------ batches


class Tally:
    """Counts of what came of the inputs, the longest time, and the largest memory.

    Args:
        state: Of what was done before, if it is kept.
    """

    def __init__(self, state: State) -> None:
        self._state = state
        self.counts: Counter[str] = Counter(state.known["counts"])
        self.slowest, self.memory = state.known["slowest"], state.known["memory"]

    @property
    def done(self) -> int:
        """Inputs so far."""
        return self.counts.total()

    def take(self, what: str, seconds: str = "0", memory: str = "0") -> None:
        """Add one input."""
        self.counts[what] += 1
        self.slowest = max(self.slowest, float(seconds))
        self.memory = max(self.memory, int(memory))
        self._state.known |= {"counts": self.counts, "slowest": self.slowest, "memory": self.memory}
        self._state.keep()

    @property
    def failed(self) -> bool:
        """Whether anything went wrong."""
        bad = ("traceback", "hang", "abort", "nameless")
        return any(self.counts[what] for what in bad) or self.memory > MOST_MEMORY

    def text(self) -> str:
        """One line."""
        c = self.counts
        return (
            f"{c['read']} read, {c['refused']} refused; {c['traceback']} tracebacks, {c['hang']} "
            f"hangs over {SLOW:g} s, {c['abort']} aborts, {c['nameless']} empty messages; slowest "
            f"{self.slowest:.1f} s, peak memory {self.memory} MB ({self._state.commits()})"
        )


def run_batch(
    kind: str, seed: int | None, count: int, folder: Path, corpus: Path, tally: Tally
) -> None:
    """Run the next inputs in a process until it ends, dies or hangs."""
    first = tally.done
    command = [sys.executable, __file__, kind, str(count), "--corpus", str(corpus)]
    command += ["--out", str(folder), "--first", str(first)]
    command += ["--worker", "corpus" if seed is None else str(seed)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, bufsize=1)
    assert process.stdout is not None
    said: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_listen, args=(process.stdout, said), daemon=True).start()
    open_now, patience = -1, START
    try:
        while words := said.get(timeout=patience).split():
            patience = SILENT
            if words[0] == "begin":
                open_now = int(words[1])
            else:
                tally.take(*words[2:])
                open_now = -1
    except queue.Empty:
        process.kill()
    status = process.wait()
    if open_now >= 0:
        what = "hang" if status == -9 else "abort"
        name, raw = given(kind, seed, open_now, seeds_of(folder / "seeds"), corpus)
        keep(folder, corpus, open_now, seed, name, raw, what)
        tally.take(what)
    elif status or tally.done < first + count:
        raise SystemExit(f"a worker ended with status {status} between two inputs")


def _listen(stream: Any, said: queue.Queue[str]) -> None:
    """Hand on each line of a process; an empty one at its end."""
    for line in stream:
        said.put(line)
    said.put("")


FRESH: dict[str, Any] = {"counts": {}, "slowest": 0.0, "memory": 0}


def fuzz(
    kind: str, count: int, seed: int, folder: Path, corpus: Path, path: Path | None = None
) -> tuple[Tally, Tally]:
    """Feed the corpus, then so many inputs; `path` is of the state file of these."""
    tally = Tally(State(path, [kind, count, seed], dict(FRESH)))
    known, again = len(kept(corpus)), Tally(State(None, [], dict(FRESH)))
    seeds = folder / "seeds"
    shutil.rmtree(seeds, ignore_errors=True)
    seeds.mkdir(parents=True)
    if kind == "cases" and (known or tally.done < count):
        parts.write_cases(seeds)  # inputs of the corpus may name files of these
    elif tally.done < count:
        parts.write_files(seeds)
    while again.done < known:
        run_batch(kind, None, known - again.done, folder, corpus, again)
    while tally.done < count:
        run_batch(kind, seed, min(BATCH, count - tally.done), folder, corpus, tally)
    return tally, again


def main() -> int:
    """Read the command line; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=("cases", "files"))
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="folder of words on inputs that failed")
    parser.add_argument("--corpus", type=Path, help="folder of inputs that failed")
    parser.add_argument("--first", type=int, default=0, help=argparse.SUPPRESS)
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    add_option(parser)
    a = parser.parse_args()
    folder = a.out or Path(tempfile.mkdtemp(prefix="cdem-fuzz-"))
    corpus = a.corpus or CORPUS / a.kind
    if a.worker:
        seed = None if a.worker == "corpus" else int(a.worker)
        work(a.kind, seed, a.first, a.count, folder, corpus)
        return 0
    tally, again = fuzz(a.kind, a.count, a.seed, folder, corpus, a.state)
    failed = tally.failed or again.failed
    where = f"; see {folder / 'failed'} and {corpus}" if failed else ""
    print(f"{a.count} {a.kind}, seed {a.seed}: {tally.text()}{where}")
    print(f"{again.done} {a.kind} of the corpus: {'some fail' if again.failed else 'all well'}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
