"""Compile the core for a GPU, check what its kernels need, import it, and put it in place.

CDEM_ISA=cuda uses it. Needs nvcc, 13 or later; no GPU, but where there is one the tests of the core
and the golden scenes run on it. The kernels are compiled for one architecture:
`pip install . -C cmake.define.CDEM_CUDA=ON` compiles them for all that CMakeLists.txt names.

With --ptx only the kernels with a limit become machine code, host code is not optimized and nothing
is put in place: all is checked that is checked without, in half the time.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

import build

ARCHITECTURE = "90"
WHEELS = "nvidia-cuda-nvcc nvidia-cuda-runtime nvidia-cuda-cccl"
# Kernels of tets, bonds, contacts and nodes: the most registers with which as many threads run at
# once as do now, and the most bytes of them that may be spilled to memory.
LIMITS = {
    "AdvanceFused<Tet4, NoFlow>": (128, 0),
    "AdvanceNodes<Dashpots>": (104, 0),
    "AdvanceNodes<NoDashpots>": (96, 0),
    "ChangeTargets": (168, 0),
    "ConformingBonds<3>, BrittleAlone": (168, 0),
    "ConformingBonds<3>, InterfaceLaws": (255, 0),
    "ConformingBonds<4>, BrittleAlone": (255, 0),
    "ConformingBonds<4>, InterfaceLaws": (255, 0),
    "CorotationalForce<Tet4, FollowRotation, NoFlow, NoRockDamping>": (128, 0),
    "CorotationalForce<Tet4, IgnoreRotation, NoFlow, NoRockDamping>": (128, 0),
    "EachNumber<1>": (32, 0),
    "FilterEdgePairs": (128, 0),
    "DropPassedTargets": (168, 0),
    "FilterNewTargets": (168, 0),
    "KineticEnergy": (40, 0),
    "MarkNearEdges": (64, 0),
    "MarkNearFaces": (80, 0),
    "MoveNodes<Dashpots>": (104, 0),
    "MoveNodes<NoDashpots>": (72, 0),
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
USED = re.compile(
    r"Compiling entry function '(\w+)'.*\n.*\n"
    r" *\d+ bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads\n"
    r".*Used (\d+) registers"
)
# PTX of a source of kernels, and the kernels in it.
PTX = re.compile(rb"\.version \d[^\0]*\.entry[^\0]*")
ENTRY = re.compile(r"\.entry (\w+)")
# The last byte of a number that is read, or written, byte by byte.
BYTE_OF_A_NUMBER = re.compile(rb"(?:ld|st)\.global\.[us]8[^;]*\+(\d+)\]")


def compiler() -> str:
    """Path of nvcc: on PATH, of the toolkit, or of its wheels in .venv."""
    wheels = Path(sysconfig.get_path("platlib")).glob("nvidia/cu*/bin/nvcc")
    for path in (shutil.which("nvcc"), "/usr/local/cuda/bin/nvcc", *sorted(wheels, reverse=True)):
        if path and Path(path).exists():
            return str(path)
    sys.exit(f"no nvcc: install the CUDA toolkit, or: .venv/bin/pip install {WHEELS}")


def refuse_layouts() -> None:
    """End where the two compilers of nvcc may give a kernel different layouts.

    With `[[no_unique_address]]` (13.0) the host packs arguments that a GPU then reads elsewhere.
    """
    for path in sorted((build.ROOT / "core").rglob("*.[ch]pp")):
        if "no_unique_address" in path.read_text():
            sys.exit(f"{path}: [[no_unique_address]] is laid out differently for host and GPU")


def compile_core(folder: Path, ptx: bool) -> bytes:
    """Compile the core; its kernels, in which the PTX is text."""
    settings = {
        "CDEM_CUDA": "ON",
        "CDEM_TESTS": "cuda",
        "CMAKE_CUDA_ARCHITECTURES": ARCHITECTURE + "-virtual" * ptx,
        "CMAKE_CUDA_COMPILER": compiler(),
        "CMAKE_CUDA_FLAGS": "--no-compress",
        "CMAKE_BUILD_TYPE": "Debug" if ptx else "Release",
        "CMAKE_CXX_FLAGS_DEBUG": "-O0 -DNDEBUG",
        "CMAKE_CUDA_FLAGS_DEBUG": "-O0 -DNDEBUG",  # of the host; a GPU's code is optimized
    }
    build.configure(folder, settings)
    build.run(["ninja", "-C", str(folder), "_core_cuda"], quiet=True)
    return (folder / "core" / "kernels" / "libkernels_cuda.a").read_bytes()


def short(name: str) -> str:
    """Name of the kernel of a loop, as the sources write it."""
    kernel = re.sub(r".*?on_gpu<(.*)>\(.*", r"\1", name).replace("cdem::", "").replace(" >", ">")
    kernel = re.sub(r"LawList<Brittle>", "BrittleAlone", kernel)
    kernel = re.sub(r"LawList<.*?>", "InterfaceLaws", kernel)
    return re.sub(r"WithLaws<(.*)>", r"\1", kernel).strip()


def names(entries: list[str]) -> dict[str, str]:
    """Short name of each kernel, by its name in PTX."""
    done = subprocess.run(
        ["c++filt"], input="\n".join(entries), capture_output=True, text=True, check=True
    )
    return {
        entry: short(name) for entry, name in zip(entries, done.stdout.splitlines(), strict=True)
    }


def assemble(ptx: bytes, entries: list[str]) -> str:
    """What the assembler says of kernels, as nvcc calls it."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "kernels.ptx"
        source.write_bytes(ptx)
        command = [str(Path(compiler()).with_name("ptxas")), "-arch", f"sm_{ARCHITECTURE}", "-m64"]
        command += ["-v", "--fmad", "false", "--entry", ",".join(entries), str(source)]
        return build.run([*command, "-o", str(source.with_suffix(".cubin"))], quiet=True)


def needs(code: bytes) -> tuple[dict[str, tuple[int, int]], int]:
    """Registers and spilled bytes of the kernels with a limit; how many kernels there are."""
    found, count = {}, 0
    for ptx in PTX.findall(code):
        short_names = names(ENTRY.findall(ptx.decode()))
        count += len(short_names)
        limited = [entry for entry, name in short_names.items() if name in LIMITS]
        rows = USED.findall(assemble(ptx, limited)) if limited else []
        for entry, stores, loads, registers in rows:
            found[short_names[entry]] = int(registers), max(int(stores), int(loads))
    return found, count


def faults(found: dict[str, tuple[int, int]], code: bytes) -> list[str]:
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
    in_bytes = sum(int(place) % 8 == 7 for place in BYTE_OF_A_NUMBER.findall(code))
    if in_bytes:
        lines.append(f"{in_bytes} numbers are read or written byte by byte: see Row of math.hpp")
    if b"ld.global.v2.f64" not in code:
        lines.append("there is no code in words to look at: was --no-compress left out?")
    return lines


def run_on_gpu(folder: Path) -> None:
    """The tests of the core, and the golden scenes, which must have the bits of the CPU."""
    build.run(["ninja", "-C", str(folder), "core_tests"], quiet=True)
    os.environ |= {"CDEM_ISA": "cuda", "OMP_NUM_THREADS": "1"}
    os.environ["CUDA_LAUNCH_BLOCKING"] = "1"  # tests look at what kernels write without waiting
    build.run([str(folder / "core_tests")])
    del os.environ["CUDA_LAUNCH_BLOCKING"]
    tests = [str(build.ROOT / "tests" / "regression" / "test_golden.py"), "-k", "pinned"]
    build.run([sys.executable, "-m", "pytest", *tests])


def main() -> None:
    """Compile, check, place and import; where there is a GPU, run on it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ptx", action="store_true", help="machine code only where it is checked")
    ptx = parser.parse_args().ptx
    folder = build.ROOT / "build" / ("ptx" if ptx else "cuda")
    refuse_layouts()
    code = compile_core(folder, ptx)
    found, count = needs(code)
    if problems := faults(found, code):
        sys.exit("\n".join(problems))
    sys.path.insert(0, str(folder))
    import _core_cuda  # imports without a GPU

    print(f"CUDA core: {count} kernels, {len(found)} of them with limits that hold; imported")
    if ptx:
        return
    build.place(folder, "_core_cuda", beside=True)
    try:
        print(f"device: {_core_cuda.device_name()}")
    except RuntimeError as error:
        print(f"device: none ({error})")
    else:
        run_on_gpu(folder)


if __name__ == "__main__":
    main()
