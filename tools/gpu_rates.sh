#!/bin/sh
# How fast is the core for a GPU? Seven minutes at most: `tools/gpu_rates.sh FOLDER`; what it prints
# goes to the folder too.
set -u
out=$1 python=${PYTHON:-.venv/bin/python}
mkdir -p "$out"
export CDEM_ISA=cuda OMP_NUM_THREADS=8
nvidia-smi --query-gpu=name,driver_version --format=csv | tee "$out/gpu.txt"
timeout 200 "$python" tools/rates.py p3 4 8 13 28 2>&1 | tee "$out/p3.txt"
timeout 60 "$python" tools/rates.py p1 3 13 2>&1 | tee "$out/p1.txt"
timeout 60 "$python" tools/rates.py p2 3 13 2>&1 | tee "$out/p2.txt"
timeout 60 ncu --set roofline -k regex:'UpdateSpring|ResolveTarget|MarkNear|MayTouch|MayMeet' -c 12 \
  "$python" tools/rates.py p3 8 >"$out/kernels.txt" 2>&1
timeout 40 nsys profile -t cuda -o "$out/p3" "$python" tools/rates.py p3 4 >"$out/trace.txt" 2>&1
