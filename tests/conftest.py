"""Let tests import the shared scenes."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
