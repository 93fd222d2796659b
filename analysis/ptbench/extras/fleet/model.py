"""Predicts a variant's time on another GPU, from its kernels' counters on one GPU and both GPUs' data sheets.

A kernel's counters give the fraction m that it reaches of the memory ceiling, and the fractions u_p of those of pipes
and caches. A fraction e of its time scales with memory, and the rest with the instruction rate:

    t' / t = e B / B' + (1 - e) max_p(u_p R_p / R'_p) / max_p(u_p)

with bandwidths B and rates R_p = multiprocessors x clock x instructions per clock of pipe p (of a cache:
multiprocessors x clock); primes are the other GPU's. Four rules give e:

- shares of time: e = m, as if memory and pipes never worked at once. Models of frequency scaling split time into a part
  that scales with memory and one that scales with the core in this way (leading loads: Keramidas et al. 2010; CRISP:
  Nath and Tullsen, MICRO 2015).
- exposed memory: e = m (1 - u) / (1 - m u), with u the nearest pipe's fraction. Memory and pipes are busy
  independently, m and u of the time, so both for m u of it, which is divided in proportion to the rest; memory alone
  has m (1 - u).
- pipes alone: as exposed memory, with u the nearest of the execution pipes. Caches are on the way to memory, and what
  passes through them does not overlap with it.
- nearest ceiling: e is 1 where memory is nearest and else 0, as in the roofline (Williams et al. 2009).

A variant's ratio is the mean over its kernels, weighted by time; the host's part of a render stays constant. Caches of
another size are not modelled: the bytes of memory traffic stay the same.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ptbench.extras.fleet.gpus import Gpu

MEMORY = "memory"
_CACHES = ("l1", "l2")


@dataclass(frozen=True)
class KernelTime:
    """The time of one kernel in a render, in any unit, and the fraction of each ceiling that the kernel reached."""

    name: str
    time: float
    shares: dict[str, float]


@dataclass(frozen=True)
class Rule:
    """A rule of prediction: its name, its statement, and the function that gives a kernel's time ratio."""

    name: str
    said: str
    ratio: Callable[[KernelTime, Gpu, Gpu], float]


def _core(kernel: KernelTime, one: Gpu, other: Gpu) -> float:
    """Ratio of the instruction-bound time: that of the pipe nearest its ceiling at the other GPU's rates."""
    core = {name: share for name, share in kernel.shares.items() if name != MEMORY}
    nearest = max(core.values())
    if nearest == 0:
        return one.rate("issue") / other.rate("issue")
    return max(share * one.rate(name) / other.rate(name) for name, share in core.items()) / nearest


def _bandwidth(one: Gpu, other: Gpu) -> float:
    return one.gb_per_second / other.gb_per_second


def _split(exposed: float, kernel: KernelTime, one: Gpu, other: Gpu) -> float:
    return exposed * _bandwidth(one, other) + (1 - exposed) * _core(kernel, one, other)


def _parts(kernel: KernelTime) -> tuple[float, float]:
    """The fractions reached of the memory ceiling and of the nearest other ceiling."""
    return min(1.0, kernel.shares[MEMORY]), max(share for name, share in kernel.shares.items() if name != MEMORY)


def _shares_of_time(kernel: KernelTime, one: Gpu, other: Gpu) -> float:
    return _split(_parts(kernel)[0], kernel, one, other)


def _exposed(memory: float, beside: float, kernel: KernelTime, one: Gpu, other: Gpu) -> float:
    """Ratio by the exposed-memory rule; `beside` is the fraction of the time in which a pipe or cache is busy."""
    if memory == 1 or beside >= 1:
        return _split(float(memory == 1), kernel, one, other)
    return _split(memory * (1 - beside) / (1 - memory * beside), kernel, one, other)


def _exposed_memory(kernel: KernelTime, one: Gpu, other: Gpu) -> float:
    return _exposed(*_parts(kernel), kernel, one, other)


def _pipes_alone(kernel: KernelTime, one: Gpu, other: Gpu) -> float:
    pipes = [share for name, share in kernel.shares.items() if name not in (MEMORY, *_CACHES)]
    return _exposed(_parts(kernel)[0], max(pipes), kernel, one, other)


def _nearest_ceiling(kernel: KernelTime, one: Gpu, other: Gpu) -> float:
    memory, core = _parts(kernel)
    return _split(float(memory > core), kernel, one, other)


def _issue(_: KernelTime, one: Gpu, other: Gpu) -> float:
    return one.rate("issue") / other.rate("issue")


def _memory(_: KernelTime, one: Gpu, other: Gpu) -> float:
    return _bandwidth(one, other)


SHARES = Rule("shares of time", "memory's part of the time scales with bandwidth", _shares_of_time)
EXPOSED = Rule("exposed memory", "the same, less what pipes do meanwhile", _exposed_memory)
PIPES = Rule("pipes alone", "the same, caches not being pipes", _pipes_alone)
# Rule that predictions of times on another GPU use: chosen on counters of an H200 and then tested on those of an H100.
USED = PIPES
RULES = (
    PIPES,
    EXPOSED,
    SHARES,
    Rule("nearest ceiling", "all of the time scales with the nearest ceiling", _nearest_ceiling),
    Rule("SMs x clock", "no counters, multiprocessors x clock alone", _issue),
    Rule("bandwidth", "no counters, bandwidth alone", _memory),
)


def predicted(kernels: Sequence[KernelTime], device_share: float, one: Gpu, other: Gpu, rule: Rule = USED) -> float:
    """Predicted time on `other` over time on `one`; `device_share` is the kernels' fraction of the render on `one`."""
    total = sum(kernel.time for kernel in kernels)
    device = sum(kernel.time * rule.ratio(kernel, one, other) for kernel in kernels) / total
    return device_share * device + (1 - device_share)


def bound_of(kernels: Sequence[KernelTime]) -> tuple[str, dict[str, float]]:
    """The ceiling nearest to which a variant runs, and the fraction it reaches of each, averaged over kernel time."""
    total = sum(kernel.time for kernel in kernels)
    names = dict.fromkeys(name for kernel in kernels for name in kernel.shares)
    shares = {name: sum(kernel.time * kernel.shares.get(name, 0.0) for kernel in kernels) / total for name in names}
    return max(shares, key=lambda name: shares[name]), shares
