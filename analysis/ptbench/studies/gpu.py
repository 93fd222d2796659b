"""Facts about the GPU that a result was measured on."""

from collections.abc import Sequence

from ptbench.io.axes import ARITHMETIC, PRECISION
from ptbench.io.cells import Cell, Kernel, Result
from ptbench.numbers import span

# Axes that affect how kernels compute; captions always tell these axes with the GPU.
KERNEL_AXES = (ARITHMETIC, PRECISION)
# Kernels that each stage launches; a library's own (for compaction or sorting) are not in result files.
_STAGE_KERNELS = {
    "generate": ("generate_paths",),
    "intersect": ("intersect_paths", "intersect_meshes"),
    "shade": ("shade_paths",),
    "first bounce": ("first_bounce", "trace_first"),
    "bounce": ("next_bounce", "shade_and_trace"),
    "walk": ("walk_paths", "walk_on"),
    "trace": ("megakernel", "megakernel_regen", "persistent", "regroup"),
}


def gpu_line(result: Result, cells: Sequence[Cell]) -> str:
    """A line on the GPU, its clock and software, and how kernels compute; empty where nothing ran on a GPU."""
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
    """Rows of facts for the summary: the GPU, its software, and its host."""
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
    """The kernel that takes most time with its registers per thread and spills, as "shade_paths 52"."""
    if cell.cuda is None or not cell.cuda.kernels:
        return ""
    stages = cell.instrumented.stage_ms if cell.instrumented is not None else {}
    kernels = cell.cuda.kernels
    timed = {name: ms for stage, ms in stages.items() for name in _STAGE_KERNELS.get(stage, ()) if name in kernels}
    # Without stage times the kernel with most registers is chosen, which is likeliest to limit occupancy.
    hottest = max(kernels, key=lambda name: (timed.get(name, 0), kernels[name].registers))
    return _kernel_text(hottest, kernels[hottest])


def _kernel_text(name: str, kernel: Kernel) -> str:
    local = f" + {kernel.local_bytes} B local" if kernel.local_bytes else ""
    return f"{name} {kernel.registers}{local}"
