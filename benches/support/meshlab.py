"""MeshLab's quadric edge collapse with its default settings (optimal placement), on raw arrays.

    python meshlab.py version
    python meshlab.py DIRECTORY TARGET

DIRECTORY holds `positions` (float32, 3 a vertex) and `indices` (uint32, 3 a triangle) of the model; the result is
written beside them as `positions.out` (float64 narrowed to float32) and `indices.out`.
"""

import os
import sys

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import importlib.metadata

import numpy
import pymeshlab


def main():
    if sys.argv[1] == "version":
        print(importlib.metadata.version("pymeshlab"))
        return
    directory, target = sys.argv[1], int(sys.argv[2])
    read = lambda name, kind: numpy.fromfile(os.path.join(directory, name), kind).reshape(-1, 3)
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(read("positions", "<f4").astype("f8"), read("indices", "<u4").astype("i4")))
    meshes.apply_filter("meshing_decimation_quadric_edge_collapse", targetfacenum=target)
    result = meshes.current_mesh()
    result.vertex_matrix().astype("<f4").tofile(os.path.join(directory, "positions.out"))
    result.face_matrix().astype("<u4").tofile(os.path.join(directory, "indices.out"))


main()
