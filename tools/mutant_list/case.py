"""Faults in `src/cdem/case`."""

from mutant_list.mutant import FAILURE, Mutant

FAULTS = [
    Mutant(
        "unasked code",
        "a case loads laws of users without being allowed to",
        "src/cdem/case/case.py",
        "if isinstance(file, str) and (source.folder / file).resolve() not in _native.headers:",
        "if not isinstance(file, str):",
        "tests/unit/test_own_laws.py",
    ),
    Mutant(
        "degrees",
        "angles of a law taken for radians",
        "src/cdem/case/laws.py",
        "values[p.name] = math.tan(math.radians(values[p.name]))",
        "values[p.name] = math.tan(values[p.name])",
        FAILURE + "test_sliding_begins_at_the_friction_angle",
    ),
    Mutant(
        "inherit",
        "a pair does not take the default's values",
        "src/cdem/case/interface_schema.py",
        "pair.__dict__[field] = getattr(self.default, field)",
        "pair.__dict__.setdefault(field, getattr(self.default, field))",
        "tests/unit/case/test_interface_schema.py",
    ),
    Mutant(
        "reduction",
        "strength reduction of the angle instead of its tangent",
        "src/cdem/case/laws.py",
        "math.degrees(math.atan(math.tan(math.radians(value)) / factor))",
        "value / factor",
        "tests/validation/test_critical.py::test_strength_reduction_gives_the_factor_of_safety",
    ),
    Mutant(
        "no limit",
        "a tensile strength that is left out is zero",
        "src/cdem/case/laws.py",
        "math.inf if v is None",
        "0.0 if v is None",
        "tests/unit/case/test_laws.py",
    ),
]
