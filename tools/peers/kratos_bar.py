"""P1 of `cdem benchmark` in Kratos: elastic tets that share nodes, explicit steps.

`peer/bin/pip install KratosMultiphysics KratosStructuralMechanicsApplication meshio`, a mesh by
`akantu_bar.py mesh 13`, then `OMP_NUM_THREADS=1 peer/bin/python tools/peers/kratos_bar.py`. Prints
million elements times steps a second of CPU time.
"""

import time

import KratosMultiphysics as kratos
import KratosMultiphysics.StructuralMechanicsApplication as structural
import meshio

MESH = "bar.msh"
STEPS = 20
REPEATS = 5
STEP = 2e-5
"""Less than a tenth of the time in which a wave crosses a tet [s]."""
CORE_VARIABLES = (
    "DISPLACEMENT VELOCITY ACCELERATION FORCE_RESIDUAL RESIDUAL_VECTOR REACTION VOLUME_ACCELERATION"
    " NODAL_MASS MOMENT_RESIDUAL"
)
VARIABLES = (
    "MIDDLE_VELOCITY FRACTIONAL_ACCELERATION FRACTIONAL_ANGULAR_ACCELERATION"
    " NODAL_DISPLACEMENT_DAMPING NODAL_INERTIA NODAL_ROTATION_DAMPING"
)


def bar(model: kratos.Model) -> kratos.ModelPart:
    """The mesh with its material."""
    part = model.CreateModelPart("bar", 2)
    for name in CORE_VARIABLES.split():
        part.AddNodalSolutionStepVariable(getattr(kratos, name))
    for name in VARIABLES.split():
        part.AddNodalSolutionStepVariable(getattr(structural, name))
    part.ProcessInfo[kratos.DOMAIN_SIZE] = 3
    rock = part.GetProperties()[1]
    rock[kratos.DENSITY], rock[kratos.YOUNG_MODULUS], rock[kratos.POISSON_RATIO] = 2500, 1e10, 0.25
    rock[kratos.CONSTITUTIVE_LAW] = structural.LinearElastic3DLaw()
    mesh = meshio.read(MESH)
    for i, point in enumerate(mesh.points):
        part.CreateNewNode(i + 1, *map(float, point))
    for i, nodes in enumerate(mesh.cells_dict["tetra"]):
        corners = [int(n) + 1 for n in nodes]
        part.CreateNewElement("SmallDisplacementElement3D4N", i + 1, corners, rock)
    for axis in "XYZ":
        names = f"DISPLACEMENT_{axis}", f"REACTION_{axis}"
        kratos.VariableUtils().AddDof(*(getattr(kratos, name) for name in names), part)
    return part


def main() -> None:
    """Time explicit steps."""
    model = kratos.Model()
    part = bar(model)
    for node in part.Nodes:
        node.SetSolutionStepValue(kratos.VELOCITY_X, 1e-3)
    scheme = structural.ExplicitCentralDifferencesScheme(STEP, 1 / 3, 0.8)
    strategy = structural.MechanicalExplicitStrategy(part, scheme, False, False, False)
    strategy.SetEchoLevel(0)
    strategy.Initialize()
    now, count = 0.0, part.NumberOfElements()
    for repeat in range(REPEATS + 1):
        began = time.process_time()
        for _ in range(STEPS):
            now += STEP
            part.CloneTimeStep(now)
            strategy.Solve()
        rate = count * STEPS / (time.process_time() - began) / 1e6
        if repeat:  # the first has what no other has
            print(f"{count:,} tets: {rate:.2f} M", flush=True)


if __name__ == "__main__":
    main()
