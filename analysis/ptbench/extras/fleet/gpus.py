"""Peak rates of GPU models: from a result file of one that ran the suite, else from a data sheet."""

import re
from dataclasses import dataclass
from functools import cache

from ptbench.errors import InputError
from ptbench.io.cells import GPU_BACKEND, Result
from ptbench.io.files import package_file
from ptbench.io.nodes import Node, read_json

SHEETS = "gpus.json"
# Execution pipes whose use is counted; a multiprocessor issues one warp instruction per scheduler and clock in all.
PIPES = ("fma", "alu", "xu")
# Schedulers per multiprocessor and lanes per warp, on every architecture since Turing.
_SCHEDULERS = 4
_LANES = 32


@dataclass(frozen=True)
class Gpu:
    """A GPU model; `per_clock` is warp instructions per clock and multiprocessor, by pipe and for "issue"."""

    name: str
    capability: str
    multiprocessors: int
    clock_mhz: float
    gb_per_second: float
    l2_bytes: int
    source: str
    per_clock: dict[str, float]

    def rate(self, pipe: str) -> float:
        """Peak rate of a pipe or "issue", 1e9 warp instructions per second; of a cache, all multiprocessors' clocks."""
        return self.multiprocessors * self.clock_mhz * self.per_clock.get(pipe, 1.0) / 1e3


@cache
def _sheets() -> Node:
    return read_json(package_file("extras", "fleet", SHEETS))


def known_gpus() -> list[str]:
    """The GPU models with a data sheet in the package."""
    return list(_sheets().need("gpus").fields())


def gpu_of_sheet(model: str) -> Gpu:
    """A GPU model from its data sheet; raises InputError."""
    if model not in known_gpus():
        raise InputError(f'--gpu: found "{model}", allowed: {", ".join(known_gpus())}')
    sheet = _sheets().need("gpus").need(model)
    capability = sheet.need("capability").name()
    return Gpu(
        sheet.need("name").name(),
        capability,
        sheet.need("multiprocessors").integer(1),
        sheet.need("clock_mhz").number(above_zero=True),
        sheet.need("gb_per_second").number(above_zero=True),
        sheet.need("l2_mib").integer(1) << 20,
        _sheets().need("sources").need(sheet.need("source").name()).name(),
        _per_clock(capability),
    )


def gpu_of_result(result: Result) -> Gpu:
    """The GPU of a result, as CUDA reported it, with two memory transfers per clock. Raises InputError."""
    if result.about("backend") != GPU_BACKEND:
        raise InputError(f"{result.path}: found the backend {result.about('backend')}, allowed: {GPU_BACKEND}")
    facts = {
        key: _reported(result, f"cuda_{key}")
        for key in ("multiprocessors", "clock_mhz", "memory_clock_mhz", "memory_bus_bits", "l2_bytes")
    }
    capability = result.about("cuda_compute_capability")
    return Gpu(
        result.about("cuda_device"),
        capability,
        round(facts["multiprocessors"]),
        facts["clock_mhz"],
        2 * facts["memory_clock_mhz"] * facts["memory_bus_bits"] / 8e3,
        round(facts["l2_bytes"]),
        "as CUDA reports it",
        _per_clock(capability),
    )


def _reported(result: Result, key: str) -> float:
    text = result.about(key)
    if not re.fullmatch(r"[1-9]\d*(\.\d+)?", text):
        raise InputError(f'{result.path}: $.context["ptbench.{key}"]: found {text}, allowed: a number above 0')
    return float(text)


def _per_clock(capability: str) -> dict[str, float]:
    known = _sheets().need("results_per_clock").fields()
    if capability not in known:
        raise InputError(f"compute capability: found {capability}, allowed: {', '.join(known)} ({SHEETS})")
    return {"issue": float(_SCHEDULERS)} | {pipe: known[capability][pipe] / _LANES for pipe in PIPES}
