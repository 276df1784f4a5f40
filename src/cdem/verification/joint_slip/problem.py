"""Slip of a joint under a harmonic shear wave (Miller)."""

import numpy as np

from cdem.run.fields import stress_of

FREQUENCY, PERIODS, START = 20.0, 2, 0.01  # of the incident wave [Hz], [1], [s]
STRENGTH = 1e4  # of the joint: normal stress times tan(45 deg) [Pa]
LENGTH, AT = 200.0, 50.0  # of a bar, from the joint to where waves are measured [m]
SHORT, NEAR = 20.0, 10.0  # the same of bars with quiet ends [m]


def theory(ratio, lag):
    """Reflected, transmitted and absorbed parts R, T, A of the amplitude; A^2 = 1 - R^2 - T^2.

    Between half spaces of impedance Z the joint carries the stress s and slips at 2 (s_in - s) / Z. A
    rigid Coulomb joint carries s_in, or its strength if that is less (Miller 1978, Bull. Seismol.
    Soc. Am. 68, 1409). One of stiffness k follows s' = 2 k (s_in - s) / Z up to its strength.

    Args:
        ratio: Amplitude of the incident stress over the strength of the joint.
        lag: w Z / 2 k, zero for a rigid joint.
    """
    phase = np.linspace(0, 2 * np.pi * (PERIODS + 1), 30001)  # the last period is still
    incident = np.where(phase < 2 * np.pi * PERIODS, np.sin(phase), 0)
    keep = np.exp(-phase[1] / lag) if lag > 0 else 0.0
    carried, stress, strength = [], 0.0, 1 / ratio
    for s in incident.tolist():
        stress = min(max(s + (stress - s) * keep, -strength), strength)
        carried.append(stress)
    total = (incident**2).sum()
    reflected, transmitted = (
        ((incident - carried) ** 2).sum() / total,
        np.square(carried).sum() / total,
    )
    return np.sqrt([reflected, transmitted, max(0.0, 1 - reflected - transmitted)])


def sent(ratio, impedance):
    """The incident wave as values of the case."""
    time = np.linspace(0, PERIODS / FREQUENCY, 100 * PERIODS + 1)[1:]
    sine = np.sin(2 * np.pi * FREQUENCY * time)
    rows = [(0, 0), (START, 0), *zip((START + time).tolist(), sine.round(12).tolist(), strict=True)]
    speed = ratio * STRENGTH / impedance
    return [f"loads.velocities.1.velocity=[0, {speed:.9g}, 0]",
            f"loads.velocities.1.history={[list(row) for row in rows]}"]  # fmt: skip


def with_quiet_ends(ratio, impedance):
    """The same wave into bars of a tenth of the length, by a record."""
    wave = np.sin(np.linspace(0, 2 * np.pi * PERIODS, 100 * PERIODS + 1))
    step = 1 / (100 * FREQUENCY)
    samples = [0.0] * round(START / step) + wave.round(12).tolist()
    bars = [f"{{size: [{SHORT:g}, 1, 1], divisions: [{SHORT:g}, 1, 1]}}"] * 2
    return [
        *(f"model.blocks.{i}.box={bar}" for i, bar in enumerate(bars)),
        f"model.blocks.0.translate=[{-SHORT:g}, 0, 0]",
        "loads.velocities=[{group: right, components: [x], velocity: [-1e-4, 0, 0], "
        "history: [[0, 0], [0.005, 1], [0.01, 0]]}]",
        f"records={{wave: {{samples: {samples}, unit: m/s, step: {step}, "
        f"scale: {ratio * STRENGTH / impedance:.9g}}}}}",
        "boundaries=[{name: near, surface: {group: left, normal: [-1, 0, 0]}, quiet: true, "
        "input: {record: wave, direction: [0, 1, 0], motion: upgoing}}, "
        "{name: far, surface: {group: right, normal: [1, 0, 0]}, quiet: true}]",
    ]


def shake(simulation, impedance, length=LENGTH, at=AT):
    """R, T, A, and the stress behind the joint over time.

    In either bar the stress s and the velocity v are split into the waves that go right,
    (v - s / Z) / 2, and left, (v + s / Z) / 2; their energies follow from the squares.
    """
    nodes = simulation.build.topology.element_nodes["hex8"]
    x = simulation.build.start_position[nodes].mean(axis=1)[:, 0]
    places = [abs(x - place).argmin() for place in (-at, at)]
    rows = []
    # until all has passed that is wanted, and before anything comes back from the ends
    until = START + (length + at) / wave_speed(simulation.case) + (PERIODS + 0.5) / FREQUENCY
    while simulation.time < until:
        simulation.step(3)
        stress = 0.5 * stress_of(simulation)[places, 3]
        simulation.step(1)  # in its middle the stress is the mean, and the velocity is of then
        stress += 0.5 * stress_of(simulation)[places, 3]
        velocity = simulation.fields["velocity"][nodes[places], 1].mean(axis=1)
        rows.append((simulation.time, *stress, *velocity))
    time, before, behind, v_before, v_behind = np.array(rows).T
    step = np.gradient(time)
    incident = ((v_before - before / impedance) ** 2) @ step
    reflected = ((v_before + before / impedance) ** 2) @ step / incident
    transmitted = ((v_behind - behind / impedance) ** 2) @ step / incident
    parts = np.sqrt([reflected, transmitted, max(0.0, 1 - reflected - transmitted)])
    return parts, (time, behind)


def wave_speed(case):
    """Of shear waves [m/s]; nu = 0."""
    rock = case.materials["rock"]
    return np.sqrt(0.5 * rock.young_modulus / rock.density)


def cross(study, ratio, *settings):
    """The lag of the joint, ours, and the stress behind the joint for one amplitude."""
    case = study.case(*settings)
    impedance = case.materials["rock"].density * wave_speed(case)
    lag = np.pi * FREQUENCY * impedance / case.interfaces.default.stiffness_s.value
    return lag, *shake(study.simulate(*settings, *sent(ratio, impedance)), impedance)


def cross_between_quiet_ends(study, ratio):
    """R, T and A of bars with quiet ends."""
    case = study.case()
    impedance = case.materials["rock"].density * wave_speed(case)
    simulation = study.simulate(*with_quiet_ends(ratio, impedance))
    return shake(simulation, impedance, SHORT, NEAR)[0]


def compare(study, ratio, *settings, name=""):
    """Check R, T and A for one amplitude; returns what `cross` does."""
    lag, ours, seen = cross(study, ratio, *settings)
    exact = theory(ratio, lag)
    # below the strength nothing is absorbed, and A is the root of the remainder of 1 - R^2 - T^2
    for letter, e, o in list(zip("RTA", exact, ours, strict=True))[: 3 if ratio > 1 else 2]:
        study.check(f"{letter}, amplitude {ratio:g} of the strength{name}", theory=e, ours=o,
                    within=2e-3, absolute=True)  # fmt: skip
    return lag, ours, seen


def run(study):
    """Several amplitudes; soft joints and other meshes when full."""
    ratios = (0.5, 1.2, 1.5, 2, 3, 5, 10, 50) if study.full else (0.5, 1.5, 3, 10)
    points, shown = [], {}
    for ratio in ratios:
        lag, ours, (time, behind) = compare(study, ratio)
        points.append(ours)
        quiet = cross_between_quiet_ends(study, ratio)
        for letter, e, o in list(zip("RTA", theory(ratio, lag), quiet, strict=True))[
            : 3 if ratio > 1 else 2
        ]:
            study.check(f"{letter}, amplitude {ratio:g} of the strength, quiet ends", theory=e, ours=o,
                        within=2e-3, absolute=True)  # fmt: skip
        if ratio in (0.5, 1.5, 10):
            shown[f"amplitude {ratio:g}"] = time, behind / STRENGTH
    line = np.geomspace(0.3, max(ratios), 60)
    rigid = np.array([theory(ratio, 0) for ratio in line])
    study.curve("A rigid joint, and cdem", "log10 of amplitude over strength [1]", "[1]",
                {f"{letter}, theory": (np.log10(line), rigid[:, i]) for i, letter in enumerate("RTA")}
                | {f".{letter}, cdem": (np.log10(ratios), np.array(points)[:, i])
                   for i, letter in enumerate("RTA")})  # fmt: skip
    study.curve("The wave behind the joint", "time [s]", "stress over strength [1]", shown)
    if study.full:
        soften(study)
        refine(study)


def soften(study):
    """Joints of less stiffness come to Miller's from afar."""
    lags, found = [], []
    for stiffness in (0.2, 0.6, 2, 6, 20):  # [GPa/m]
        setting = f"interfaces.default.stiffness_s={stiffness} GPa/m"
        lag, ours, _ = compare(study, 3, setting, name=f", {stiffness:g} GPa/m")
        lags.append(lag)
        found.append(ours[0])
    exact = [theory(3, lag)[0] for lag in lags]
    study.curve("Joints of stiffness k, amplitude 3", "w Z / 2k [1]", "R [1]", {
        "theory": (lags, exact), "rigid": (lags, [theory(3, 0)[0]] * len(lags)),
        ".cdem": (lags, found)})  # fmt: skip


def refine(study):
    """The error against the size of the elements, at 10 times the strength."""
    rows = []
    for cells in (100, 200, 400):
        bars = [f"model.blocks.{i}.box.divisions=[{cells}, 1, 1]" for i in (0, 1)]
        lag, ours, _ = cross(study, 10, *bars)
        rows.append((LENGTH / cells, abs(ours - theory(10, lag)).max()))
    h, error = np.transpose(rows)
    study.check("order of convergence, amplitude 10, 1 to 0.5 m", theory=2,
                ours=np.log2(error[1] / error[2]), within=0.2, absolute=True)  # fmt: skip
    study.curve("Largest error of R, T and A, amplitude 10", "element [m]", "error [1]",
                {".cdem": (h, error), "second order": (h, error[-1] * (h / h[-1]) ** 2)}, log=True)  # fmt: skip
