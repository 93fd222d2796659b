#!/usr/bin/env python3
"""Traces the rays and the mesh that `ptbench rays --write-rays F --write-mesh M.ply` wrote, through Mitsuba 3.

Mitsuba's variant cuda_ad_rgb uses OptiX, llvm_ad_rgb Embree. Prints JSON: rates by class of rays, and whether as many
rays hit as in ptbench. Ray file format: harness/rays/ray_file.h. Mitsuba is optional; so is NumPy, which reads faster.
"""

import argparse
import json
import struct
import sys
import time
from array import array
from pathlib import Path
from statistics import median

HEAD = struct.Struct("<24sIIQQ")
RAY_FLOATS = 8
LARGEST_FLOAT = 3.4028234663852886e38


def ray_sets(path):
    """The ray sets of a file, each as class, whether any hit will do, rays as an array of floats, number of hits."""
    with path.open("rb") as file:
        magic, count, _ = struct.unpack("<8sII", file.read(16))
        if magic != b"PTBRAYS1":
            raise ValueError(f"{path}: found another kind of file, allowed: PTBRAYS1")
        for _ in range(count):
            name, any_hit, _, rays, hits = HEAD.unpack(file.read(HEAD.size))
            values = array("f")
            values.fromfile(file, rays * RAY_FLOATS)
            yield name.rstrip(b"\0").decode(), bool(any_hit), values, hits


def columns_of(values):
    """Origin, t_max and direction as seven sequences of floats; an infinite t_max becomes Mitsuba's largest float."""
    try:
        import numpy as np
    except ImportError:
        columns = [values[k::RAY_FLOATS] for k in range(7)]
        columns[3] = array("f", (min(t, LARGEST_FLOAT) for t in columns[3]))
        return columns
    table = np.frombuffer(values, dtype=np.float32).reshape(-1, RAY_FLOATS)
    columns = [np.ascontiguousarray(table[:, k]) for k in range(7)]
    columns[3] = np.minimum(columns[3], np.float32(LARGEST_FLOAT))
    return columns


def device_rays(mi, values):
    """The rays in the memory of the device on which Mitsuba traces."""
    x, y, z, t_max, along_x, along_y, along_z = [mi.Float(column) for column in columns_of(values)]
    return mi.Ray3f(mi.Point3f(x, y, z), mi.Vector3f(along_x, along_y, along_z), t_max, 0.0, [])


def traced(mi, dr, scene, ray, any_hit):
    """Traces one batch; returns milliseconds of its kernels, of wall time, and the number of hits."""
    dr.eval(ray)
    dr.sync_thread()
    dr.kernel_history_clear()
    start = time.perf_counter()
    if any_hit:
        met = scene.ray_test(ray, coherent=False)
        dr.eval(met)
    else:
        hit = scene.ray_intersect_preliminary(ray, coherent=False)
        dr.eval(hit.t, hit.prim_index)
        met = hit.is_valid()
    dr.sync_thread()
    wall = (time.perf_counter() - start) * 1e3
    kernels = sum(entry["execution_time"] for entry in dr.kernel_history([dr.KernelType.JIT]))
    return kernels or wall, wall, int(dr.count(met)[0])


def measured(mi, dr, scene, path, repetitions):
    """The measured rates, one entry per ray set of the file."""
    for name, any_hit, values, hits in ray_sets(path):
        rays = len(values) // RAY_FLOATS
        ray = device_rays(mi, values)
        runs = [traced(mi, dr, scene, ray, any_hit) for _ in range(repetitions + 1)][1:]
        milliseconds = [kernel for kernel, _, _ in runs]
        yield {
            "class": name,
            "query": "any" if any_hit else "closest",
            "rays": rays,
            "ms": milliseconds,
            "median_ms": median(milliseconds),
            "wall_median_ms": median(wall for _, wall, _ in runs),
            "grays_per_s": rays / median(milliseconds) * 1e-6,
            "hits": runs[0][2],
            "ptbench_hits": hits,
            "hits_differ": abs(runs[0][2] - hits),
        }


def arguments():
    """Parses the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", type=Path, help="what --write-mesh wrote (.ply)")
    parser.add_argument("rays", type=Path, help="what --write-rays wrote")
    parser.add_argument("--variant", default="cuda_ad_rgb", help="cuda_ad_rgb (OptiX) or llvm_ad_rgb (Embree)")
    parser.add_argument("--repetitions", type=int, default=9)
    call = parser.parse_args()
    for path in (call.mesh, call.rays):
        if not path.is_file():
            parser.error(f"{path}: found no such file")
    return call


def main():
    """Prints the rates of all ray sets; exit code 3 without Mitsuba."""
    call = arguments()
    try:
        import drjit as dr
        import mitsuba as mi
    except ImportError as error:
        print(f"optix_peer: Mitsuba 3 is not installed ({error}); pip install mitsuba", file=sys.stderr)
        return 3
    try:
        mi.set_variant(call.variant)
        dr.set_flag(dr.JitFlag.KernelHistory, True)
        start = time.perf_counter()
        scene = mi.load_dict(
            {"type": "scene", "mesh": {"type": "ply", "filename": str(call.mesh), "face_normals": True}}
        )
        dr.sync_thread()
        load_ms = (time.perf_counter() - start) * 1e3
        rows = list(measured(mi, dr, scene, call.rays, call.repetitions))
    except (ImportError, RuntimeError, ValueError, EOFError, struct.error) as error:
        print(f"optix_peer: {' '.join(str(error).split())}", file=sys.stderr)
        return 3
    result = {
        "mesh": str(call.mesh),
        "variant": call.variant,
        "mitsuba": mi.__version__,
        "repetitions": call.repetitions,
        "statistic": "median of the kernels' execution times",
        "load_and_build_ms": load_ms,
        "batches": rows,
    }
    print(json.dumps(result, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
