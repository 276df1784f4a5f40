"""Mean slopes of CFFA over both dips beside those of the paper: python slopes.py study.sweep"""

import csv
import sys
from pathlib import Path

import numpy as np

with (Path(sys.argv[1]) / "table.csv").open() as file:
    rows = [row for row in csv.DictReader(file) if row["status"] == "found"]
table = {n: np.array([float(r[n]) for r in rows]) for n in ("DACN", "DACW", "CFFA", "closed_form")}
plane = np.column_stack([table["DACN"], table["DACW"], np.ones(len(rows))])
ours, exact = (np.linalg.lstsq(plane, table[n], rcond=None)[0] for n in ("CFFA", "closed_form"))
print("mean slope over   cdem   closed form   paper")
for i, (dip, paper) in enumerate((("DACN", 0.90), ("DACW", -0.19))):
    print(f"{dip:<16}{ours[i]:>+7.3f}{exact[i]:>+14.3f}{paper:>+8.2f}")
error = np.abs(table["CFFA"] - table["closed_form"])
print(f"{len(rows)} points, largest difference from the closed form {error.max():.3f} deg")
sys.exit(1 if error.max() > 0.1 else 0)
