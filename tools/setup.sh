#!/usr/bin/env bash
# Make .venv and install cdem with its tools into it. Installs missing Debian packages when it may.
set -euo pipefail
cd "$(dirname "$0")/.."
PYTHON=${PYTHON:-python3}

missing=()
command -v g++ >/dev/null || missing+=(g++)
command -v make >/dev/null || missing+=(make)
command -v "$PYTHON" >/dev/null || missing+=(python3)
"$PYTHON" -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3-venv)
"$PYTHON" -c 'import os, sysconfig, sys
sys.exit(not os.path.exists(sysconfig.get_path("include") + "/Python.h"))' 2>/dev/null ||
  missing+=(python3-dev)
g++ -E -x c++ -include doctest/doctest.h /dev/null >/dev/null 2>&1 || missing+=(doctest-dev)
# pyvista draws without a screen through OSMesa. ldconfig lies outside an ordinary user's PATH, and
# piping it into grep -q fails now and then under pipefail (grep leaves first).
libraries=$(PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null || true)
[[ $libraries == *libOSMesa* ]] || missing+=(libosmesa6)
[[ $libraries == *libGL.so.1* ]] || missing+=(libgl1)
[[ $libraries == *libXrender* ]] || missing+=(libxrender1)

install() {
  [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null || return 1
  echo "installing Debian packages: $*"
  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "$@" >/dev/null
}

if ((${#missing[@]})) && ! install "${missing[@]}"; then
  echo "missing system packages; install them with:" >&2
  echo "  sudo apt-get install ${missing[*]}" >&2
  case " ${missing[*]} " in
    *" g++ "* | *" make "* | *" python3"*) exit 1 ;;
    *) echo "(only pictures and the tests of the core need these; going on)" >&2 ;;
  esac
fi

[ -x .venv/bin/python ] || "$PYTHON" -m venv .venv
.venv/bin/python -m pip install -q --upgrade pip
.venv/bin/python -m pip install -q "scikit-build-core>=0.10" "nanobind>=2.4" "cmake>=3.27" ninja
# The core for this CPU is compiled while pip fetches the rest.
mkdir -p build
.venv/bin/python tools/build.py --native >build/setup.log 2>&1 &
core=$!
PATH="$PWD/.venv/bin:$PATH" .venv/bin/python -m pip install -q --no-compile --no-build-isolation \
  -C build-dir=build/setup -C cmake.define.CDEM_ISAS= -e '.[dev]'
wait "$core" || { cat build/setup.log >&2; exit 1; }
