"""The answer does not depend on frame, hand, threads, noise, and hardly on the step."""

import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import meshio
import numpy as np

from cdem.errors import CaseError
from cdem.model.bodies import read_model
from cdem.output.render import snapshot
from cdem.run.simulation import Simulation
from cdem.verification.runner import problems

NOISE = 1e-12  # [m]
CELL_NAMES = {"tet4": "tetra", "pyramid5": "pyramid", "wedge6": "wedge", "hex8": "hexahedron"}
MIRRORED = {  # the nodes of a cell in an order that gives its mirror image a volume above zero
    "tet4": [0, 2, 1, 3],
    "pyramid5": [0, 3, 2, 1, 4],
    "wedge6": [3, 4, 5, 0, 1, 2],
    "hex8": [4, 5, 6, 7, 0, 1, 2, 3],
}


@dataclass
class Scene:
    """A case, and how far its answers may differ, as parts of the longest way of a node.

    Attributes:
        file: Of the case.
        settings: Changes of the case.
        frame: For another frame or hand.
        noise: For nodes that are moved by `NOISE`.
        step: For half the time step.
        bonds: Whether there are bonds; the same number must break.
        quick: Whether it belongs to the quick part.
    """

    file: str
    settings: list[str] = field(default_factory=list)
    frame: float = 1e-9
    noise: float = 1e-8
    step: float = 0.01
    bonds: bool = False
    quick: bool = True


def only(duration, contact=0.1):
    """Settings that make one dynamic stage of all, without local damping, which knows the axes."""
    damping = f"{{contact: {contact}, stiffness: 0.2}}"
    return [f"stages=[{{name: go, mode: dynamic, duration: {duration}, damping: {damping}}}]"]


def resting(lower, upper, quick=True):
    """One of the six contact types: it goes down by micrometres, so the last digits count more."""
    [types] = problems(["contact_types"])
    settings = [*types.module.LOWER[lower], *types.module.UPPER[upper], *only(0.02, 0.25)]
    return Scene("../contact_types/case.yaml", settings, frame=2e-8, noise=1e-6, step=5e-4,
                 quick=quick)  # fmt: skip


def scenes():
    """All by name."""
    slope = ["model.blocks.0.box.divisions=[20, 8, 1]", "stages.0.duration=0.1"]
    less = ["interfaces.a.friction_angle=5", "interfaces.b.friction_angle=7"]
    bars = [f"model.blocks.{i}.box={{size: [20, 0.5, 0.5], divisions: [40, 1, 1]}}" for i in (0, 1)]
    stiff = ["materials.rock.young_modulus=10 GPa", "interfaces.default.friction_angle=45",
             "interfaces.default.stiffness_n=10 E/h", "interfaces.default.stiffness_s=10 E/h",
             "elements.mass=exact", *only(0.003)]  # fmt: skip
    # held along no axis alone; nu = 0 keeps the bars straight
    pulse = [*bars, "model.blocks.0.translate=[-20, 0, 0]", "groups.left.fix=[]",
             "groups.right.fix=[]", "loads.velocities.0.components=[x, y, z]",
             "loads.velocities.0.box={min: [-20.01, -1, -1], max: [-19.99, 1, 1]}",
             "stages.0.duration=0.02", "elements.mass=exact"]  # fmt: skip
    arch, slope_of_columns, dominoes = problems(["arch", "goodman_bray", "dominoes"])
    thin, columns = arch.module.settings(0.45), slope_of_columns.module.settings()
    tip = resting("vertex", "vertex")
    # given steps: how early an automatic one is cut depends on the boxes of the search, which have
    # axes, and bounces multiply the difference
    row = [*dominoes.module.settings(0.02, hinged=True), "time.step=1 us"]
    tip.settings += ["time.step=10 us", "model.blocks.1.translate=[0.01, 0.004, 0.001]",
                     "groups.upper.velocity=[0, 0, -0.5]"]  # fmt: skip
    return {
        "tumbling tetrahedron": Scene("tumble.yaml", ["time.step=50 us"]),
        "beam that cracks": Scene("beam.yaml", step=2e-3, bonds=True),
        "swinging square": Scene("../swing/case.yaml", ["stages.0.duration=1"], step=2e-4),
        "slide over 160 hexahedra": Scene("../sliding/case.yaml", slope, step=2e-4, quick=False),
        "slide on edges": Scene("../crossed/case.yaml", only(0.005), frame=1.2e-7, noise=4e-6),
        "wedge that slides": Scene("../wedge/case.yaml", [*less, *only(0.1)], step=1e-3),
        "block on a slope": Scene("../friction/case.yaml", stiff, frame=2e-8),
        "column that topples": Scene(
            "../toppling/case.yaml", ["loads.gravity=[2.704, 0, -9.43]", *only(0.2)], step=5e-4,
            quick=False,
        ),
        "shaken block": Scene("../newmark/case.yaml", only(0.65), step=1e-3, quick=False),
        "pulse across a joint": Scene("../joint_wave/case.yaml", pulse, frame=1e-8, bonds=True,
                                      step=5e-4, quick=False),
        "tower that is tilted": Scene("../tower/case.yaml", ["loads.gravity=[4.905, 0, -8.496]",
                                                            *only(0.05)], quick=False),
        # feet that stand on quadrilaterals at a gap of zero: round-off decides which step is the first
        "arch that is too thin": Scene("../arch/case.yaml", [thin, *only(0.02)], frame=2e-4,
                                       noise=1e-5, step=2e-3, quick=False),
        "columns on a stepped base": Scene("../goodman_bray/case.yaml", [
            columns, "interfaces.default.friction_angle=30", *only(0.02)], quick=False,
            frame=5e-8, noise=1e-7),
        "slide along an apparent dip": Scene("../apparent_dip/case.yaml", [
            "loads.gravity=[0, 0, -9.81]", "interfaces.bed.friction_angle=10",
            "interfaces.wall.friction_angle=5", *only(0.05)], quick=False),
        "row of dominoes": Scene("../dominoes/case.yaml", [*row, *only(0.08, 2)], noise=1.3e-7,
                                 quick=False),
        "face on face": resting("face", "face"),
        "edge on face": resting("face", "edge", quick=False),
        "vertex on face": resting("face", "vertex"),
        "edge on edge": resting("edge", "edge"),
        "vertex on edge": resting("edge", "vertex", quick=False),
        "vertex on vertex": tip,
    }  # fmt: skip


def theory():
    """Newton's laws know no frame, no hand, and no computer: every difference should be zero."""
    return 0.0


def random_frame(rng):
    """A rotation matrix, all equally likely."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def write_mesh(mesh, path):
    """Write a mesh with its groups and surfaces to the bit; read it with `cdem.mesh.read_mesh`."""
    cells = [(CELL_NAMES[shape], rows) for shape, rows in mesh.cells.items()]
    tags = [mesh.cell_group[shape] + 1 for shape in mesh.cells]
    names = {name: np.array([i + 1, 3]) for i, name in enumerate(mesh.group_names)}
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    meshio.write(path, meshio.Mesh(mesh.points, cells, cell_data=data, field_data=names), "gmsh22")


def move(case, turn, noise, path):
    """Put a case into another frame: its mesh, gravity, motions, tractions and supports.

    Args:
        case: Is changed.
        turn: Rotation matrix, or one with a mirror.
        noise: Added to the points of the mesh [m], shape (points, 3), or 0.
        path: For the mesh.

    Raises:
        CaseError: Something acts along an axis alone, which no case can say in another frame.
    """
    mesh = read_model(case)
    before, hand = mesh.points, np.linalg.det(turn)
    mesh.points = before @ turn.T + noise
    if hand < 0:
        mesh.cells = {shape: rows[:, MIRRORED[shape]] for shape, rows in mesh.cells.items()}
    write_mesh(mesh, path)

    def turned(vector):
        return (turn @ np.asarray(vector, float)).tolist()

    case.set("model", {"mesh": str(path), "split": case.model.split})
    case.loads.gravity = turned(case.loads.gravity)
    for stage in case.stages:
        if "loads.gravity" in stage.set:
            stage.set["loads.gravity"] = turned(stage.set["loads.gravity"])
    for group in case.groups.values():
        group.velocity = turned(group.velocity)
        group.angular_velocity = (hand * np.array(turned(group.angular_velocity))).tolist()
    loads = case.loads
    for item in (*loads.tractions, *loads.supports, *loads.velocities):
        if hasattr(item.surface, "normal"):
            item.surface.normal = turned(item.surface.normal)
    for traction in loads.tractions:
        traction.traction = turned(traction.traction)
    for driven in loads.velocities:
        driven.velocity = turned(driven.velocity)
    axes = [group.fix for group in case.groups.values()]
    axes += [support.fix for support in loads.supports] + [v.components for v in loads.velocities]
    if any(len(a) not in (0, 3) for a in axes):
        raise CaseError("a support along some axes alone cannot be turned")
    loads.supports = points_of_boxes(loads.supports, before, mesh.points)
    loads.velocities = points_of_boxes(loads.velocities, before, mesh.points)


def points_of_boxes(items, before, after):
    """Replace each selection of nodes by a box, which has axes, by one for every point in it."""
    out = []
    for item in items:
        if item.box is None:
            out.append(item)
            continue
        inside = ((before >= item.box.min) & (before <= item.box.max)).all(axis=1)
        out += [item.model_copy(update={"box": None, "point": x.tolist()}) for x in after[inside]]
    return out


def in_order(built):
    """Nodes by first cell of their block and by point: an order that no frame changes."""
    t = built.topology
    first = np.full(len(t.block_group), np.iinfo(np.int64).max)
    start = 0
    for shape, block in t.element_block.items():
        np.minimum.at(first, block, start + t.element_cell[shape].astype(np.int64))
        start += len(block)
    return np.lexsort([t.node_point, first[t.node_block]])


@dataclass
class Answer:
    """Results of a run.

    Attributes:
        way: Of each node [m], shape (nodes, 3), in the frame of the scene.
        broken: Broken semi-springs.
        shown: Surfaces at the start and at the end.
    """

    way: np.ndarray
    broken: int
    shown: list


def answer(study, scene, *, turn=None, noise=None, threads=1, settings=()):
    """Run a scene in another frame, with noise, threads or settings."""
    turn = np.eye(3) if turn is None else turn
    case = study.case(*scene.settings, *settings, file=scene.file)
    with tempfile.TemporaryDirectory() as folder:
        points = len(read_model(case).points)
        added = 0 if noise is None else noise.uniform(-NOISE, NOISE, (points, 3))
        move(case, turn, added, Path(folder) / "mesh.msh")
        simulation = Simulation(case, threads=threads)
    shown = [snapshot(simulation)]
    last = case.stages[-1]
    if len(case.stages) > 1:
        simulation.run_stage(case.stages[-2].name)
    start = simulation.time
    simulation.run()
    position = simulation.fields["position"].copy()
    if last.duration is not None:  # a run ends up to a step late
        position -= (simulation.time - start - last.duration) * simulation.fields["velocity"]
    shown.append(snapshot(simulation))
    way = (position - simulation.build.start_position) @ turn
    return Answer(way[in_order(simulation.build)], sum(simulation.broken.values()), shown)


def run(study):
    """Each change of each scene against the same run without it."""
    rng = np.random.default_rng(7)
    for name, scene in scenes().items():
        if not (scene.quick or study.full):
            continue
        reference = answer(study, scene)
        study.picture(f"{name}, start and end", *reference.shown)
        step = study.case(*scene.settings, file=scene.file).time.step
        half = "time.safety=0.4" if step == "auto" else f"time.step={step / 2}"
        changes = {
            "rotated": ({"turn": random_frame(rng)}, scene.frame),
            "mirrored": ({"turn": -random_frame(rng)}, scene.frame),
            "moved by 1e-12 m": ({"noise": rng}, scene.noise),
            "half the step": ({"settings": [half]}, scene.step),
            "two threads": ({"threads": 2}, 0.0),
        }
        longest = np.linalg.norm(reference.way, axis=1).max()
        for what, (change, within) in changes.items():
            ours = answer(study, scene, **change)
            study.check(f"{name}, {what}", theory=theory(), within=within, absolute=True,
                        ours=np.abs(ours.way - reference.way).max() / longest)  # fmt: skip
            if scene.bonds:
                study.check(f"{name}, {what}: broken semi-springs", theory=reference.broken,
                            ours=ours.broken, within=0, absolute=True)  # fmt: skip
