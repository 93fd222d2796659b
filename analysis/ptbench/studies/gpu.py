"""What a result file says of the GPU that ran it."""

from collections.abc import Sequence

from ptbench.io.cells import Cell, Kernel, Result
from ptbench.numbers import span

# The axes that say how the device computes: the GPU's line has them, fixed or not.
KERNEL_AXES = ("arithmetic", "precision")
# The kernels of a stage; a library's own (a compaction's, a sort's) are not in the file.
_STAGE_KERNELS = {
    "generate": ("generate_paths",),
    "intersect": ("intersect_paths",),
    "shade": ("shade_paths",),
    "first bounce": ("first_bounce",),
    "bounce": ("next_bounce",),
    "walk": ("walk_paths", "walk_on"),
    "trace": ("megakernel", "megakernel_regen", "persistent", "regroup"),
}


def gpu_line(result: Result, cells: Sequence[Cell]) -> str:
    """The device, its clock and software, and how the kernels compute; empty where nothing ran on one."""
    on_gpu = [cell for cell in cells if cell.on_gpu]
    if not on_gpu:
        return ""
    name = result.about("cuda_device")
    facts = []
    if capability := result.context.get("ptbench.cuda_compute_capability"):
        facts.append(f"compute capability {capability}")
    if multiprocessors := result.context.get("ptbench.cuda_multiprocessors"):
        facts.append(f"{multiprocessors} multiprocessors")
    clocks = [
        clock
        for cell in on_gpu
        for sample in cell.samples
        for clock in (sample.clock_mhz_before, sample.clock_mhz_after)
        if clock
    ]
    clock = f"rated {result.about('cuda_clock_mhz')} MHz"
    if clocks:
        clock += f", {span(round(clock) for clock in clocks)} MHz round the samples"
    parts = [
        f"GPU {name}" + (f" ({', '.join(facts)})" if facts else ""),
        f"clock {clock}",
        f"CUDA driver {result.about('cuda_driver')}, NVRTC {result.about('cuda_nvrtc')}",
    ]
    for axis in KERNEL_AXES:
        choices = list(dict.fromkeys(cell.axes[axis] for cell in on_gpu if axis in cell.axes))
        parts.append(f"{axis} {', '.join(choices) or 'unknown'}")
    return "; ".join(parts) + "."


def about_gpu(result: Result, host: str) -> list[tuple[str, str]]:
    """Rows of the summary's head: the device, its software, and the host that feeds it."""
    shown = [
        ("", "cuda_device"), ("compute capability", "cuda_compute_capability"),
        ("multiprocessors:", "cuda_multiprocessors"), ("clock MHz:", "cuda_clock_mhz"),
        ("memory MiB:", "cuda_memory_mib"), ("memory clock MHz:", "cuda_memory_clock_mhz"),
        ("bus bits:", "cuda_memory_bus_bits"), ("L2 bytes:", "cuda_l2_bytes"), ("ECC:", "cuda_ecc"),
    ]  # fmt: skip
    software = [
        ("driver", "cuda_driver"), ("runtime", "cuda_runtime"), ("NVRTC", "cuda_nvrtc"), ("CCCL", "cuda_cccl"),
        ("kernel sources", "cuda_kernel_source_hash"),
    ]  # fmt: skip
    options = [cell.cuda.options for cell in result.cells if cell.cuda is not None]
    everywhere = [
        option for option in dict.fromkeys(o for of in options for o in of) if all(option in of for of in options)
    ]
    return [
        ("GPU", ", ".join(f"{name} {result.about(key)}".strip() for name, key in shown)),
        ("CUDA", ", ".join(f"{name} {result.about(key)}" for name, key in software)),
        *([("NVRTC options of every cell", f"`{' '.join(everywhere)}`")] if everywhere else ()),
        ("Host", host),
    ]


def hottest_kernel(cell: Cell) -> str:
    """ "shade_paths 52": registers a thread of the kernel that takes most of the time; and what it spills."""
    if cell.cuda is None or not cell.cuda.kernels:
        return ""
    stages = cell.instrumented.stage_ms if cell.instrumented is not None else {}
    kernels = cell.cuda.kernels
    timed = {name: ms for stage, ms in stages.items() for name in _STAGE_KERNELS.get(stage, ()) if name in kernels}
    # Without stage times, the one that is most likely to limit how many threads fit.
    hottest = max(kernels, key=lambda name: (timed.get(name, 0), kernels[name].registers))
    return _kernel_text(hottest, kernels[hottest])


def _kernel_text(name: str, kernel: Kernel) -> str:
    local = f" + {kernel.local_bytes} B local" if kernel.local_bytes else ""
    return f"{name} {kernel.registers}{local}"
