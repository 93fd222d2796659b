"""Mitsuba 3 as a peer: a persistent process of its own Python, which imports nothing but the wheel.

`mitsuba_peer.py VARIANT ESTIMATOR MODE` reads one request in JSON per line and answers each in one line: {"error"} or
what docs/other_renderers.md lists. ESTIMATOR is `path`, Mitsuba's own integrator of the scene, or `bsdf`, the
integrator defined below that samples no lights; MODE is `megakernel` (symbolic loops) or `evaluated` (one kernel per
iteration). Exit code 4: Mitsuba cannot be imported.
"""

import json
import re
import sys
import time

MISSING = 4
_MAX_DEPTH = re.compile(r"max_depth = (\d+)")


def register_bsdf_sampling(mi, dr):
    """Registers an integrator without next-event estimation, like direct_light=off: no shadow rays, no weights."""
    # Code that dr.syntax generates finds `mi` and `dr` only among the module's globals.
    globals().update(mi=mi, dr=dr)

    class BsdfSampling(mi.SamplingIntegrator):
        def __init__(self, props):
            super().__init__(props)
            self.max_depth = props.get("max_depth", 8)

        @dr.syntax
        def sample(self, scene, sampler, ray, medium=None, active=True):
            # The path loop changes its ray, so it works on a copy; the caller's ray must not change.
            ray = mi.Ray3f(ray)
            radiance, throughput = mi.Spectrum(0), mi.Spectrum(1)
            segments, active, met = mi.UInt32(0), mi.Bool(active), mi.Bool(False)
            context = mi.BSDFContext()
            while active:
                surface = scene.ray_intersect(ray, active)
                radiance += throughput * surface.emitter(scene).eval(surface, active)
                met |= active & surface.is_valid()
                segments += 1
                active &= surface.is_valid() & (segments < self.max_depth)
                drawn, weight = surface.bsdf(ray).sample(
                    context, surface, sampler.next_1d(active), sampler.next_2d(active), active
                )
                throughput *= weight
                ray = surface.spawn_ray(surface.to_world(drawn.wo))
                active &= dr.max(throughput) != 0
            return radiance, met, []

    mi.register_integrator("ptbench_bsdf_sampling", BsdfSampling)


class Renderer:
    """Mitsuba with one variant, estimator and mode, and the scene that was loaded last."""

    def __init__(self, mi, dr, variant, estimator, mode):
        mi.set_variant(variant)
        self.mi, self.dr, self.variant, self.estimator, self.mode = mi, dr, variant, estimator, mode
        self.compiles = "scalar" not in variant
        if mode == "evaluated" and not self.compiles:
            raise ValueError(f"{variant} has no loops to evaluate")
        if estimator == "bsdf":
            if not self.compiles:
                raise ValueError(f"{variant}: the integrator in Python would be timed as Python")
            register_bsdf_sampling(mi, dr)
        if self.compiles:
            dr.set_flag(dr.JitFlag.KernelHistory, True)
            dr.set_flag(dr.JitFlag.SymbolicLoops, mode == "megakernel")

    def about(self, _):
        """Versions of the program that a result must record."""
        said = {"version": self.mi.__version__, "drjit": self.dr.__version__, "variant": self.variant}
        if "llvm" in self.variant:
            said["threads"] = int(self.dr.thread_count())
        return said

    def load(self, request):
        """Loads the scene file of the request."""
        begun = time.perf_counter()
        self.scene = self.mi.load_file(request["xml"])
        self.integrator = self.scene.integrator()
        if self.estimator == "bsdf":
            depth = int(_MAX_DEPTH.search(str(self.integrator))[1])
            self.integrator = self.mi.load_dict({"type": "ptbench_bsdf_sampling", "max_depth": depth})
        self._wait()
        return {"load_ms": 1e3 * (time.perf_counter() - begun)}

    def image(self, request):
        """Renders a seed's picture and writes it to the requested file."""
        film, said = self._rendered(request["spp"], request["seed"])
        self.mi.Bitmap(film).write(request["file"])
        return said

    def times(self, request):
        """Renders once for warm-up, then the requested number of timed renders."""
        self._rendered(request["spp"], request["seed"])
        return {"renders": [self._rendered(request["spp"], request["seed"])[1] for _ in range(request["repetitions"])]}

    def _wait(self):
        if self.compiles:
            self.dr.sync_thread()

    def _rendered(self, spp, seed):
        self._wait()
        if self.compiles:
            self.dr.kernel_history_clear()
        begun = time.perf_counter()
        film = self.mi.render(self.scene, integrator=self.integrator, spp=spp, seed=seed)
        if self.compiles:
            self.dr.eval(film)
        self._wait()
        wall_ms = 1e3 * (time.perf_counter() - begun)
        if not self.compiles:
            return film, {"ms": wall_ms, "wall_ms": wall_ms, "compile_ms": 0.0, "kernels": 0}
        # Dr.Jit's kernel history has every kernel, fills and reductions included; times are device or CPU thread ms.
        history = self.dr.kernel_history()
        compiled = sum(one.get("codegen_time", 0) + one.get("backend_time", 0) for one in history)
        kernels_ms = sum(one.get("execution_time", 0) for one in history)
        return film, {
            "ms": float(kernels_ms), "wall_ms": wall_ms, "compile_ms": float(compiled), "kernels": len(history),
        }  # fmt: skip


def _one_line(error):
    # Dr.Jit wraps errors in its own exceptions, so the innermost cause is reported.
    while error.__cause__ is not None:
        error = error.__cause__
    return " ".join(f"{type(error).__name__}: {error}".split())[:500]


def main():
    """Answers requests from standard input until it ends."""
    try:
        import drjit as dr
        import mitsuba as mi
    except ImportError as error:
        print(error, file=sys.stderr)
        return MISSING
    # Libraries print to standard output, which carries the answers, so their output is redirected to stderr.
    answers, sys.stdout = sys.stdout, sys.stderr
    renderer = None
    for line in sys.stdin:
        try:
            request = json.loads(line)
            renderer = renderer or Renderer(mi, dr, *sys.argv[1:4])
            said = getattr(renderer, request["do"])(request)
        except Exception as error:  # any exception of a plugin becomes an answer to the request
            said = {"error": _one_line(error)}
        print(json.dumps(said), file=answers, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
