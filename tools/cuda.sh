#!/usr/bin/env bash
# Compile and import the CUDA module from the shared headers wherever an nvcc is found.
set -euo pipefail
cd "$(dirname "$0")/.."
nvcc=$(command -v nvcc || ls /usr/local/cuda/bin/nvcc .venv/lib/python3*/site-packages/nvidia/cu13/bin/nvcc \
  2>/dev/null | head -n 1 || true)
if [ -z "$nvcc" ]; then
  echo "no nvcc found: the CUDA module was not compiled"
  exit 0
fi
export PATH="$PWD/.venv/bin:$PATH"
cmake -S . -B build/cuda -G Ninja -DCDEM_CUDA=ON -DCMAKE_CUDA_COMPILER="$nvcc" \
  -DPython_EXECUTABLE="$PWD/.venv/bin/python" >/dev/null
cmake --build build/cuda --target _cuda
.venv/bin/python - <<'PY'
import sys

sys.path.insert(0, "build/cuda")
import _cuda  # imports without a GPU

try:
    print("CUDA module compiled and imported; device:", _cuda.device_name())
except RuntimeError as error:
    print("CUDA module compiled and imported;", error)
PY
