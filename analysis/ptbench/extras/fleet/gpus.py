"""What models of GPU can do at most: from the result file of one that ran the suite, else from a data sheet."""

import re
from dataclasses import dataclass
from functools import cache

from ptbench.errors import InputError
from ptbench.io.cells import GPU_BACKEND, Result
from ptbench.io.files import package_file
from ptbench.io.nodes import Node, read_json

SHEETS = "gpus.json"
# Pipes that execute warps' instructions; a multiprocessor issues as many of all together as it has schedulers.
PIPES = ("fma", "alu", "xu")
# Schedulers and lanes of every architecture from Turing on; a scheduler issues one warp's instruction a clock.
_SCHEDULERS = 4
_LANES = 32


@dataclass(frozen=True)
class Gpu:
    """A model of GPU; `per_clock` is warps' instructions a clock and multiprocessor by pipe, "issue" among them."""

    name: str
    capability: str
    multiprocessors: int
    clock_mhz: float
    gb_per_second: float
    l2_bytes: int
    source: str
    per_clock: dict[str, float]

    def rate(self, pipe: str) -> float:
        """1e9 warps' instructions a second of a pipe, or of "issue"; of a cache clocks of all multiprocessors."""
        return self.multiprocessors * self.clock_mhz * self.per_clock.get(pipe, 1.0) / 1e3


@cache
def _sheets() -> Node:
    return read_json(package_file("extras", "fleet", SHEETS))


def known_gpus() -> list[str]:
    """Models of which there is a data sheet."""
    return list(_sheets().need("gpus").fields())


def gpu_of_sheet(model: str) -> Gpu:
    """The model's data sheet; raises InputError."""
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
    """The GPU that ran, as CUDA reported it: memory moves twice a memory clock. Raises InputError."""
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
