"""Compile the core as other systems would: `make portable`. Needs clang++; no OpenMP.

- By clang without OpenMP, two lanes, no warnings; the tests of the core, and the pinned results: the
  same bits.
- The syntax alone, by the library that macOS has (libc++), and for 64-bit ARM; needs the Debian
  packages in HEADERS.
"""

import os
import shutil
import subprocess
import sys

import build

FOLDER = build.ROOT / "build" / "portable"
HEADERS = {
    "-stdlib=libc++": "libc++-dev",
    "--target=aarch64-linux-gnu": "libstdc++-12-dev-arm64-cross",
}
"""Ways to compile, and the Debian package that each needs."""
SYNTAX = "-std=gnu++20 -fsyntax-only -I. -DCDEM_LANES=2 -Wall -Wextra -Werror -Wno-unknown-pragmas"
WITHOUT = ("base/emulated.cpp",)
"""What only the emulated device needs."""


def core() -> str:
    """The instruction set of two lanes."""
    return "x86_64" if build.native() != "generic" else "generic"


def check_results() -> None:
    """Build core and tests without OpenMP, and run them."""
    settings = {"CMAKE_CXX_COMPILER": "clang++", "CMAKE_DISABLE_FIND_PACKAGE_OpenMP": "ON"}
    settings |= {"CMAKE_CXX_FLAGS": "-Werror", "CDEM_ISAS": core(), "CDEM_TESTS": core()}
    build.configure(FOLDER, settings)
    build.run(["ninja", "-C", str(FOLDER), f"_core_{core()}", "core_tests"])
    build.run([str(FOLDER / "core_tests")])
    build.place(FOLDER, f"_core_{core()}", beside=True)
    try:
        os.environ["CDEM_ISA"] = core()
        pinned = "tests/regression/test_golden.py"
        build.run([sys.executable, "-m", "pytest", str(build.ROOT / pinned), "-k", "pinned"])
    finally:  # `make build` puts the one with OpenMP in its place
        for module in build.PLACE.glob(f"_core_{core()}.*"):
            module.unlink()


def check_syntax() -> None:
    """Read all sources of the core in each of the ways whose headers are here."""
    sources = sorted(build.ROOT.glob("core/**/*.cpp"))
    sources = [str(one) for one in sources if not str(one).endswith(WITHOUT)]
    for way, package in HEADERS.items():
        command = ["clang++", *SYNTAX.split(), "-Wno-psabi", "-Wno-bitwise-instead-of-logical", way]
        one = [*command, "-include", "vector", "-x", "c++", os.devnull]
        if subprocess.run(one, check=False, capture_output=True).returncode:
            print(f"{way}: not tried, no headers ({package})")
            continue
        os.chdir(build.ROOT)
        build.run([*command, *sources])
        print(f"{way}: {len(sources)} files compile")


def main() -> None:
    """Check both."""
    if not shutil.which("clang++"):
        sys.exit("make portable needs clang++ (Debian package clang)")
    check_syntax()
    check_results()


if __name__ == "__main__":
    main()
