"""Renders with Mitsuba 3, in a process and, if need be, a Python of its own: it takes nothing but the wheel.

A job in JSON on standard input, {"variant", "xml", "spp", "images": [[seed, file.pfm], ..]}; a line of JSON on standard
output, {"version", "variant", "seconds"}. Without "xml" it only answers. Exit code 4: Mitsuba cannot be imported.
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
    """Renders what a job file asks for, and returns the exit code."""
    try:
        import mitsuba
    except ImportError as error:
        print(error, file=sys.stderr)
        return MISSING
    job = json.load(sys.stdin)
    variant = _variant(mitsuba, job["variant"])
    mitsuba.set_variant(variant)
    mitsuba.set_log_level(mitsuba.LogLevel.Error)  # it warns on standard output, which the answer goes to
    begun = time.perf_counter()
    if "xml" in job:
        scene = mitsuba.load_file(job["xml"])
        for seed, target in job["images"]:
            mitsuba.Bitmap(mitsuba.render(scene, spp=job["spp"], seed=seed)).write(target)
    print(json.dumps({"version": mitsuba.__version__, "variant": variant, "seconds": time.perf_counter() - begun}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
