"""A slab halved by a plane on which a disc is a joint and the rest a rock bridge."""

import numpy as np


def theory(bridge, on_bridge, on_joint, rock, crack):
    """Shear force at which a bridge breaks and a joint slips [N].

    Args:
        bridge: Area of the bridge [m2].
        on_bridge: Normal force on the bridge [N].
        on_joint: The same on the joint [N].
        rock: Interface of the bridge.
        crack: Interface of the joint.
    """
    friction = [np.tan(np.radians(law.friction_angle)) for law in (rock, crack)]
    return bridge * rock.cohesion + on_bridge * friction[0] + on_joint * friction[1]


def drive(simulation, start, fine, end):
    """Rows of time, force on the slab's base along x and z, and forces of contacts, until all breaks.

    Forces of contacts are those of one side on the other: sums of friction and of pressure. The last
    row is the last with all bonds whole.
    """
    base = np.flatnonzero(simulation.build.start_position[:, 2] < 1e-9)
    simulation.run_until(start)
    rows = []
    while simulation.time < end and not sum(simulation.broken.values()):
        force = simulation.fields["reaction"][base].sum(axis=0)
        touch = simulation.contacts["force"]
        sided = (touch * np.sign(touch[:, 2:])).sum(axis=0)
        rows.append((simulation.time, -force[0], force[2], abs(sided[0]), abs(sided[2])))
        simulation.run_until(simulation.time + (5e-4 if simulation.time < fine else 1e-4))
    return np.array(rows).T


def run(study):
    """Areas, then shear under pressure, then tension."""
    simulation = study.simulate()
    areas = simulation.audit.discs["crack"]
    bridge, rock = areas["bridge_area"], simulation.case.interfaces.default
    disc = np.pi * 0.3989422804**2
    study.check("area of the joint", theory=disc, ours=areas["joint_area"], within=1e-3, unit="m2")
    study.check("area of joint and bridge", theory=1, ours=areas["joint_area"] + bridge,
                within=1e-12, unit="m2")  # fmt: skip

    time, shear, pressed, friction, on_joint = drive(simulation, 0.03, 0.082, 0.12)
    crack = simulation.case.interfaces.pairs[0]
    limit = theory(bridge, pressed - on_joint, on_joint, rock, crack)
    study.check("friction of the joint", theory=theory(0, 0, on_joint[-1], rock, crack),
                ours=friction[-1], within=1e-4, unit="N")  # fmt: skip
    study.check("shear force at which the bridge breaks", theory=limit[-1], ours=shear[-1],
                within=5e-3, unit="N")  # fmt: skip
    study.curve("Shear force on the slab", "time [s]", "force [N]", {
        "bridge and friction of the joint": (time, limit), ".shear force": (time, shear)})  # fmt: skip

    simulation = study.simulate(file="pull.yaml")
    time, _, pulled, _, _ = drive(simulation, 0.01, 0.062, 0.12)
    study.check("tension at which the bridge breaks", theory=bridge * rock.tensile_strength,
                ours=-pulled[-1], within=1e-2, unit="N")  # fmt: skip
