"""Plane wave across one elastic joint (Schoenberg)."""

import numpy as np

AT = 50.0  # where the transmitted wave is recorded [m]


def theory(frequency, impedance, stiffness):
    """|T| = 1 / sqrt(1 + (w Z / 2 k)^2), Schoenberg (1980, J. Acoust. Soc. Am. 68, 1516)."""
    return 1 / np.sqrt(1 + (np.pi * frequency * impedance / stiffness) ** 2)


def spectrum(simulation, axis, frequencies, until):
    """Amplitude of the velocity at `AT` at some frequencies, up to a time."""
    node = np.abs(simulation.build.start_position - [AT, 0, 0]).sum(axis=1).argmin()
    rows = []
    while simulation.time < until:
        simulation.step(1)
        rows.append((simulation.time, simulation.fields["velocity"][node, axis]))
    time, velocity = np.array(rows).T
    phase = np.exp(-2j * np.pi * np.outer(frequencies, time))
    return np.abs(phase @ (velocity * np.gradient(time))), (time, velocity)


def short(kind):
    """Settings of bars of 30 m and 60 m with quiet ends: less than a quarter of the elements."""
    axis = "xy"[kind == "S"]
    direction = [float(a == axis) for a in "xyz"]
    samples = [0, 0.2, 0.4, 0.6, 0.8, 1, 0.8, 0.6, 0.4, 0.2, 0]  # the pulse of the long bars [mm/s]
    return [
        "model.blocks.0.box={size: [30, 0.5, 0.5], divisions: [60, 1, 1]}",
        "model.blocks.0.translate=[-30, 0, 0]",
        "model.blocks.1.box={size: [60, 0.5, 0.5], divisions: [120, 1, 1]}",
        "loads.velocities=[]",
        f"records={{pulse: {{samples: {samples}, unit: m/s, step: 1 ms, scale: 1e-3}}}}",
        "boundaries=[{name: near, surface: {group: left, normal: [-1, 0, 0]}, quiet: true, "
        f"input: {{record: pulse, direction: {direction}, motion: upgoing}}}}, "
        "{name: far, surface: {group: right, normal: [1, 0, 0]}, quiet: true}]",
        *(["groups.left.fix=[x, z]", "groups.right.fix=[x, z]"] if kind == "S" else []),
    ]


def run(study):
    """The pulse with the joint over the pulse without it, frequency by frequency."""
    frequencies = np.array([10.0, 25.0, 50.0, 100.0])
    ways = {"P": (0, []), "S": (1, ["groups.left.fix=[x, z]", "groups.right.fix=[x, z]",
            "loads.velocities.0.components=[y]", "loads.velocities.0.velocity=[0, 1e-3, 0]"])}  # fmt: skip
    for kind, (axis, settings) in ways.items():
        joint = study.simulate(*settings)
        rock, law = joint.case.materials["rock"], joint.case.interfaces.default
        modulus = rock.young_modulus * (1 if kind == "P" else 0.5)  # nu = 0
        c = np.sqrt(modulus / rock.density)
        until = 245 / c  # before the reflection from the far end arrives
        ours, seen = spectrum(joint, axis, frequencies, until)
        whole = ["model.blocks.0.box={size: [200, 0.5, 0.5], divisions: [400, 1, 1]}",
                 "model.blocks.1.translate=[0, 10, 0]"]  # fmt: skip
        incident, sent = spectrum(study.simulate(*settings, *whole), axis, frequencies, until)
        stiffness = law.stiffness_n.value if kind == "P" else law.stiffness_s.value
        exact = theory(frequencies, rock.density * c, stiffness)
        for f, t, measured in zip(frequencies, exact, ours / incident, strict=True):
            study.check(f"{kind} wave, |T| at {f:g} Hz", theory=t, ours=measured, within=0.01)
        bars = short(kind)
        ends = [spectrum(study.simulate(*bars, *more), axis, frequencies, until)[0]
                for more in ([], ["interfaces.default.stiffness_n=800 GPa/m",
                                  "interfaces.default.stiffness_s=800 GPa/m"])]  # fmt: skip
        for f, t, measured in zip(frequencies[:3], exact, ends[0] / ends[1], strict=False):
            study.check(f"{kind} wave, |T| at {f:g} Hz, quiet ends", theory=t, ours=measured,
                        within=0.01)  # fmt: skip
        study.curve(f"{kind} wave behind the joint", "time [s]", "velocity [m/s]",
                    {"with the joint": seen, "without it": sent})  # fmt: skip
        smooth = np.linspace(5, 110, 50)
        study.curve(f"Transmission of {kind} waves", "frequency [Hz]", "|T| [1]",
                    {"theory": (smooth, theory(smooth, rock.density * c, stiffness)),
                     ".cdem": (frequencies, ours / incident)})  # fmt: skip
