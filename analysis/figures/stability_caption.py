"""What stands under every figure of stability."""

from __future__ import annotations

from collections.abc import Sequence

from analysis.stability_file import Stability


def setting(stability: Stability) -> str:
    """Machine, commit, date: one line."""
    machine = f"Machine {stability.about('machine')}: "
    if stability.about("backend") == "cuda":
        facts = [f"GPU {stability.about('cuda_device')}"]
        if stability.context.get("ptbench.cuda_driver"):
            facts.append(f"CUDA driver {stability.about('cuda_driver')}, NVRTC {stability.about('cuda_nvrtc')}")
        machine += "; ".join(facts)
    else:
        machine += f"{stability.about('cpu_model')}, {stability.about('threads')} threads"
    run = f"{'quick' if stability.is_quick else 'full'} run"
    run += "" if stability.seed is None else f", seed {stability.seed}"
    return (
        f"{machine}; backend {stability.about('backend')}; ptbench {stability.about('version')}, git {stability.git}, "
        f"{run}, {stability.context.get('date') or 'no date'}."
    )


def caption(stability: Stability, what: str, remarks: Sequence[str] = ()) -> str:
    notes = [] if stability.is_complete else [f"Note: the run is not complete ({stability.about('status')})."]
    return "\n".join([what, *remarks, setting(stability), *notes])
