"""Renders with Mitsuba 3 in a process of its own, if need be by another Python: it imports nothing but the wheel.

Reads a job in JSON from standard input, {"variant", "xml", "spp", "images": [[seed, file.pfm], ..]}, and writes JSON to
standard output, {"version", "variant", "seconds"}. Without "xml" nothing is rendered. Exit code 4: no Mitsuba.
"""

import json
import sys
import time

MISSING = 4


def _variant(mitsuba, wanted: str) -> str:
    if wanted != "auto":
        return wanted
    import drjit

    on_gpu = "cuda_ad_rgb" in mitsuba.variants() and drjit.has_backend(drjit.JitBackend.CUDA)
    return "cuda_ad_rgb" if on_gpu else "scalar_rgb"


def main() -> int:
    """Renders what the job on standard input asks for, and returns the exit code."""
    try:
        import mitsuba
    except ImportError as error:
        print(error, file=sys.stderr)
        return MISSING
    job = json.load(sys.stdin)
    variant = _variant(mitsuba, job["variant"])
    mitsuba.set_variant(variant)
    mitsuba.set_log_level(mitsuba.LogLevel.Error)  # keep warnings off stdout, which carries the worker's answer
    begun = time.perf_counter()
    if "xml" in job:
        scene = mitsuba.load_file(job["xml"])
        for seed, target in job["images"]:
            mitsuba.Bitmap(mitsuba.render(scene, spp=job["spp"], seed=seed)).write(target)
    print(json.dumps({"version": mitsuba.__version__, "variant": variant, "seconds": time.perf_counter() - begun}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
