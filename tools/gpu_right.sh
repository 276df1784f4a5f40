#!/bin/sh
# Is the core for a GPU right? Seven minutes at most: `tools/gpu_right.sh HASHES FOLDER`, with the
# hashes that `tools/hashes.py --write` has found on a CPU; what it prints goes to the folder too.
set -u
hashes=$1 out=$2 python=${PYTHON:-.venv/bin/python}
mkdir -p "$out"
export CDEM_ISA=cuda OMP_NUM_THREADS=8
nvidia-smi --query-gpu=name,driver_version --format=csv | tee "$out/gpu.txt"
timeout 60 build/cuda/core_tests 2>&1 | tail -5 | tee "$out/tests.txt"
timeout 200 "$python" tools/hashes.py --against "$hashes" 2>&1 | tee "$out/hashes.txt"
timeout 70 compute-sanitizer --tool memcheck "$python" tools/hashes.py --steps 20 p3 2>&1 |
  tail -20 | tee "$out/memory.txt"
timeout 70 compute-sanitizer --tool racecheck "$python" tools/hashes.py --steps 5 p1 2>&1 |
  tail -20 | tee "$out/races.txt"
