"""Compile the core for a GPU, put it in place, import it, and check what its kernels need.

CDEM_ISA=cuda uses it. Needs nvcc, 13 or later; no GPU, but where there is one the tests of the core
and the golden scenes run on it. The kernels are compiled for one architecture:
`pip install . -C cmake.define.CDEM_CUDA=ON` compiles them for all that CMakeLists.txt names.
"""

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import build

FOLDER = build.ROOT / "build" / "cuda"
ARCHITECTURE = "90"
WHEELS = "nvidia-cuda-nvcc nvidia-cuda-runtime nvidia-cuda-cccl"
# Kernels of tets, bonds, contacts and nodes: the most registers with which as many threads run at
# once as do now, and the most bytes of them that may be spilled to memory.
LIMITS = {
    "AdvanceFused<Tet4, false, NoFlow>": (128, 0),
    "AdvanceFused<Tet4, true, NoFlow>": (128, 0),
    "AdvanceNodes": (96, 0),
    "ChangeTargets": (168, 0),
    "ConformingBonds<3>, BrittleAlone": (168, 0),
    "ConformingBonds<3>, InterfaceLaws": (255, 0),
    "ConformingBonds<4>, BrittleAlone": (255, 0),
    "ConformingBonds<4>, InterfaceLaws": (255, 0),
    "CorotationalForce<Tet4, FollowRotation, NoFlow>": (128, 0),
    "CorotationalForce<Tet4, IgnoreRotation, NoFlow>": (128, 0),
    "FilterEdgePairs": (128, 0),
    "FilterNewTargets": (168, 0),
    "MarkNearEdges": (64, 0),
    "MarkNearFaces": (80, 0),
    "MoveNodes": (72, 0),
    "OverlapBonds, BrittleAlone": (255, 0),
    "OverlapBonds, InterfaceLaws": (255, 8),
    "ResolveTargetEdges": (168, 0),
    "ResolveTargets": (168, 0),
    "SumNodeForces": (56, 0),
    "UpdateEdgeForces<ElasticUnloading>, BrittleAlone": (168, 0),
    "UpdateEdgeForces<ElasticUnloading>, InterfaceLaws": (168, 0),
    "UpdateHeldTargets": (128, 0),
    "UpdateSpringForces<ElasticUnloading>, BrittleAlone": (168, 0),
    "UpdateSpringForces<ElasticUnloading>, InterfaceLaws": (255, 0),
}
LEAST_REGISTERS = 16
KERNEL = re.compile(
    r"Compiling entry function '(\w+)'.*\n.*\n"
    r" *\d+ bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads\n"
    r".*Used (\d+) registers"
)
# The last byte of a number that is read, or written, byte by byte.
BYTE_OF_A_NUMBER = re.compile(rb"(?:ld|st)\.global\.[us]8[^;]*\+(\d+)\]")


def compiler() -> str:
    """Path of nvcc: on PATH, of the toolkit, or of its wheels in .venv."""
    wheels = Path(sysconfig.get_path("platlib")).glob("nvidia/cu*/bin/nvcc")
    for path in (shutil.which("nvcc"), "/usr/local/cuda/bin/nvcc", *sorted(wheels, reverse=True)):
        if path and Path(path).exists():
            return str(path)
    sys.exit(f"no nvcc: install the CUDA toolkit, or: .venv/bin/pip install {WHEELS}")


def compile_kernels() -> str:
    """Compile all kernels once more and return what the assembler says of them."""
    build.configure(
        FOLDER,
        {
            "CDEM_CUDA": "ON",
            "CMAKE_CUDA_ARCHITECTURES": ARCHITECTURE,
            "CMAKE_CUDA_COMPILER": compiler(),
            "CMAKE_CUDA_FLAGS": "-Xptxas -v --no-compress",
            "CDEM_TESTS": "cuda",
        },
    )
    build.run(["ninja", "-C", str(FOLDER), "-t", "clean", "kernels_cuda"])
    return build.run(["ninja", "-C", str(FOLDER), "kernels_cuda"], quiet=True)


def short(name: str) -> str:
    """Name of the kernel of a loop, as the sources write it."""
    kernel = re.sub(r".*?on_gpu<(.*)>\(.*", r"\1", name).replace("cdem::", "").replace(" >", ">")
    kernel = re.sub(r"LawList<Brittle>", "BrittleAlone", kernel)
    kernel = re.sub(r"LawList<.*?>", "InterfaceLaws", kernel)
    return re.sub(r"WithLaws<(.*)>", r"\1", kernel).strip()


def needs(log: str) -> dict[str, tuple[int, int]]:
    """Registers and spilled bytes of every kernel."""
    rows = KERNEL.findall(log)
    names = subprocess.run(
        ["c++filt"],
        input="\n".join(row[0] for row in rows),
        capture_output=True,
        text=True,
        check=True,
    ).stdout.splitlines()
    return {
        short(name): (int(registers), max(int(stores), int(loads)))
        for name, (_, stores, loads, registers) in zip(names, rows, strict=True)
    }


def faults(found: dict[str, tuple[int, int]]) -> list[str]:
    """What is over its limit or empty, and numbers that are read or written byte by byte."""
    lines = [f"LIMITS names {name}, which is no kernel" for name in LIMITS.keys() - found.keys()]
    for name, limits in LIMITS.items():
        for value, limit, what in zip(
            found.get(name, (0, 0)), limits, ("registers", "bytes spilled"), strict=True
        ):
            if value > limit:
                lines.append(f"{name}: {value} {what}, at most {limit} allowed")
    # what the compiler takes for undefined becomes an empty kernel, without a word
    lines += [
        f"{name}: {found[name][0]} registers, too few to do anything"
        for name in LIMITS.keys() & found.keys()
        if found[name][0] < LEAST_REGISTERS
    ]
    code = (FOLDER / "core" / "kernels" / "libkernels_cuda.a").read_bytes()
    in_bytes = sum(int(place) % 8 == 7 for place in BYTE_OF_A_NUMBER.findall(code))
    if in_bytes:
        lines.append(f"{in_bytes} numbers are read or written byte by byte: see Row of math.hpp")
    if b"ld.global.v2.f64" not in code:
        lines.append("there is no code in words to look at: was --no-compress left out?")
    return lines


def run_on_gpu() -> None:
    """The tests of the core, and the golden scenes, which must have the bits of the CPU."""
    build.run(["ninja", "-C", str(FOLDER), "core_tests"], quiet=True)
    build.run([str(FOLDER / "core_tests")])
    os.environ |= {"CDEM_ISA": "cuda", "OMP_NUM_THREADS": "1"}
    tests = [str(build.ROOT / "tests" / "regression" / "test_golden.py"), "-k", "pinned"]
    build.run([sys.executable, "-m", "pytest", *tests])


def main() -> None:
    """Compile, check, place and import; where there is a GPU, run on it."""
    found = needs(compile_kernels())
    if problems := faults(found):
        sys.exit("\n".join(problems))
    build.run(["ninja", "-C", str(FOLDER), "_core_cuda"], quiet=True)
    build.place(FOLDER, "_core_cuda", beside=True)
    sys.path.insert(0, str(FOLDER))
    import _core_cuda  # imports without a GPU

    print(f"CUDA core: {len(found)} kernels within their limits, imported")
    try:
        print(f"device: {_core_cuda.device_name()}")
    except RuntimeError as error:
        print(f"device: none ({error})")
        return
    run_on_gpu()


if __name__ == "__main__":
    main()
