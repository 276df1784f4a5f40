"""The process that reads meshes in HDF5 files, see `cdem.case.reader_process`."""

from __future__ import annotations

from cdem.case import reader_process
from cdem.mesh.mesh_arrays import to_arrays
from cdem.mesh.mesh_files import MEND, read_here

if __name__ == "__main__":
    import h5py  # noqa: F401  # loading takes longer than reading is allowed
    import meshio  # noqa: F401

    reader_process.answer(lambda path, _: to_arrays(read_here(path)), MEND)
