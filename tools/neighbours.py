#!/usr/bin/env python3
"""Times renders on GPU 0 while GPU 1 of the same host rests, computes, or moves memory.

    tools/neighbours.py --binary build/ptbench --out results/nvidia-h200/neighbours

Runs the suite `neighbours` four times on GPU 0: alone, beside a GPU 1 that renders in registers, beside one that
renders through memory, and alone again. Each leaves a result file in the folder: alone.json, beside_computing.json,
beside_moving.json, alone_again.json. What they tell is in docs/findings/devices.md.
Needs the standard library alone, and a host with two GPUs; about a minute.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

COMMON = ["--scene", "cornell_open", "--backend", "cuda", "--resolution", "800x800", "--depth", "8", "--untuned"]
# Options of the call that GPU 1 repeats endlessly: renders of about a second.
NEIGHBOURS = {
    "computing": ["--axis", "integrator=persistent", "--axis", "arithmetic=exact", "--spp", "16384"],
    "moving": [
        *("--axis", "integrator=wavefront", "--axis", "compaction=cub_select_flagged", "--axis", "layout=packed"),
        *("--axis", "launch=graph", "--axis", "arithmetic=exact", "--tune", "spp_in_flight=4", "--spp", "4096"),
    ],
}
LEAST_USE, LONGEST_START = 90, 20.0  # percentage of use from which GPU 1 is busy, longest wait for it in seconds
_ENDLESS = "10000"  # number of repetitions that never ends in practice


def environment(gpu: int) -> dict[str, str]:
    """A copy of this process's environment in which only one GPU is visible."""
    shown = os.environ.get("CUDA_VISIBLE_DEVICES", "0,1").split(",")
    if len(shown) < 2:
        raise SystemExit(f"CUDA_VISIBLE_DEVICES: found {','.join(shown)}, allowed: two GPUs")
    return os.environ | {"CUDA_VISIBLE_DEVICES": shown[gpu]}


def use_of(gpu: int) -> int | None:
    """The GPU utilisation that the driver reports, in percent; None where nvidia-smi does not tell."""
    shown = os.environ.get("CUDA_VISIBLE_DEVICES", "0,1").split(",")[gpu]
    asked = ["nvidia-smi", f"--id={shown}", "--query-gpu=utilization.gpu", "--format=csv,noheader,nounits"]
    try:
        return int(subprocess.run(asked, capture_output=True, text=True, check=True, timeout=10).stdout)
    except (OSError, subprocess.SubprocessError, ValueError):
        return None


def wait_until_busy(neighbour: subprocess.Popen) -> None:
    """Waits until GPU 1 is busy; raises SystemExit where the neighbour ended or never began."""
    start = time.monotonic()
    while neighbour.poll() is None:
        used = use_of(1)
        seconds = time.monotonic() - start
        if (used is not None and used >= LEAST_USE) or (used is None and seconds > LONGEST_START / 4):
            print(f"GPU 1 is busy after {seconds:.1f} s: {used} %", flush=True)
            return
        if seconds > LONGEST_START:
            neighbour.kill()
            raise SystemExit(f"GPU 1 does not get busy: {used} %")
        time.sleep(0.3)
    raise SystemExit(f"the neighbour ended with exit code {neighbour.returncode}")


def timed(binary: Path, out: Path) -> None:
    """Runs the suite `neighbours` once on GPU 0."""
    call = [str(binary), "run", "--suite", "neighbours", "--backend", "cuda", "--untuned", "--quiet", "--overwrite"]
    if (code := subprocess.run([*call, "--out", str(out)], env=environment(0), check=False).returncode) != 0:
        raise SystemExit(f"{out}: exit code {code}")


def beside(binary: Path, work: str, out: Path) -> None:
    """Runs the suite `neighbours` on GPU 0 while GPU 1 renders."""
    image = out.with_suffix(".neighbour.pfm")
    call = [str(binary), "render", *COMMON, *NEIGHBOURS[work], "--repetitions", _ENDLESS, "--out", str(image)]
    with subprocess.Popen(call, env=environment(1), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as neighbour:
        try:
            wait_until_busy(neighbour)
            timed(binary, out)
            if neighbour.poll() is not None:
                raise SystemExit(f"the neighbour ended before the run did, with exit code {neighbour.returncode}")
        finally:
            neighbour.kill()
    image.unlink(missing_ok=True)


def main() -> int:
    """Measures all four settings; returns exit code 0 if all results were written."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=Path, default=Path("build/ptbench"))
    parser.add_argument("--out", type=Path, required=True, help="folder for the results")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    timed(arguments.binary, arguments.out / "alone.json")
    for work in NEIGHBOURS:
        beside(arguments.binary, work, arguments.out / f"beside_{work}.json")
    timed(arguments.binary, arguments.out / "alone_again.json")
    return 0


if __name__ == "__main__":
    sys.exit(main())
