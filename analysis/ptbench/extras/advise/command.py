"""`advise`: recommends a variant for a scene, with the expected gain and the measurements that it rests on."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.extras.advise.advice import Advised, advise_on, alternatives, is_timed, lines_of, models_of, settings_of
from ptbench.extras.advise.check import Checked, check
from ptbench.extras.advise.evidence import Book, results_of
from ptbench.extras.advise.mapped import whole_book
from ptbench.extras.advise.model import WITHIN
from ptbench.extras.advise.probe import Probed, file_of, probe
from ptbench.extras.advise.trying import Asked, try_advice
from ptbench.numbers import figures, interval
from ptbench.program import Program
from ptbench.terminal import say

ADVICE = "advice.json"
_TRIED_AT = (96, 96)
_OTHERS = 3  # rivals of the advised choice that `--measure` runs


@dataclass(frozen=True)
class Call:
    """The options of one call of `advise`."""

    scene: str
    gpu: str | None = None
    cpu: bool = False
    measure: bool = False
    depth: int | None = None
    resolution: tuple[int, int] | None = None
    spp: int = 4
    root: Path = Path()
    results: Path | None = None  # folder of benchmark results; None: the checkout's own
    binary: Path | None = None  # path of the ptbench program; None: the checkout's own
    tried: int | None = None  # number of generated scenes to try the advice on, in place of a given scene
    seed: int = 1
    loaded: bool = False
    out: Path | None = None  # file into which a try of the advice on generated scenes writes its results
    resume: bool = False


def advise(call: Call) -> int:
    """Runs `advise`; exit code 1: a measurement found the advice not within 5 % of the best, or too rarely so."""
    program = Program(call.binary or call.root / "build" / "ptbench")
    results = call.results or call.root / "results"
    machine, backend, note = machine_of(results, program, call.gpu, cpu=call.cpu)
    if call.tried is not None:
        out = call.out or results / program.machine() / ADVICE
        asked = Asked(call.tried, call.seed, call.resolution or _TRIED_AT, call.spp, out, call.loaded, call.resume)
        return try_advice(program, call.root, results, machine, backend, asked)
    probed = probe(program, file_of(call.scene, call.root), backend, call.depth, call.resolution)
    book = whole_book(call.root, results, machine, backend)
    say(f"{probed.name}: {probed.features.text()}")
    say(f"from the results of {book.device} (results/{machine}){note}")
    advised = advise_on(models_of(book), probed.features, probed.barred, book.baselines)
    for line in lines_of(advised, probed.features):
        say(line)
    _say_missing(book)
    settings = settings_of(advised)
    words = " ".join(f"--{'tune' if value.isdigit() else 'axis'} {name}={value}" for name, value in settings.items())
    say(f"all together: {program.binary} render --backend {backend} --scene {probed.scene} {words}")
    return _measured(call, program, probed, advised, backend) if call.measure else 0


def _say_missing(book: Book) -> None:
    if book.without:
        say(f"left out, as their scenes are not there: {', '.join(book.without)}")


def machine_of(results: Path, program: Program, gpu: str | None, *, cpu: bool) -> tuple[str, str, str]:
    """The folder of results to use, its backend, and a note on that choice; raises InputError."""
    folders = (
        {folder.name: folder for folder in sorted(results.iterdir()) if folder.is_dir()} if results.is_dir() else {}
    )
    backends = {name: backend for name, folder in folders.items() if (backend := _backend(folder))}
    if gpu is not None:
        wanted = [name for name, backend in backends.items() if backend == "cuda" and _has(name, gpu)]
        if len(wanted) != 1:
            known = ", ".join(name for name, backend in backends.items() if backend == "cuda") or "none in results/"
            raise bad_value("--gpu", "model", f'"{gpu}"', f"one of {known}, or a part of its name")
        return wanted[0], "cuda", ""
    own = program.machine()
    if own in backends and (not cpu or backends[own] == "cpu"):
        return own, backends[own], ""
    others = [name for name, backend in backends.items() if backend == "cpu"]
    if not others or (own.startswith("nvidia-") and not cpu):
        allowed = f"--gpu MODEL of {', '.join(name for name in backends if name not in others)}, or --cpu"
        raise bad_value(results, "machine", f"no results of {own}", allowed)
    return others[0], "cpu", f"; this machine is {own}, of which there are none: its caches and cores are others"


def _has(name: str, gpu: str) -> bool:
    return gpu.lower().replace(" ", "-") in name


def _backend(folder: Path) -> str:
    """The backend of the first result in a folder; empty where there is no result."""
    return next((result.context.get("ptbench.backend", "") for _, result in results_of(folder)), "")


def _measured(call: Call, program: Program, probed: Probed, advised: Sequence[Advised], backend: str) -> int:
    """Measures the advice: varies one decision at a time, with the advised choices for the others."""
    timed = [one for one in advised if is_timed(one)]
    settings = settings_of(timed)
    code = 0
    for one in timed:
        rest = {name: value for name, value in settings.items() if name not in _own(one)}
        variants = [{**rest, **one.decision.reference, **dict(choice)} for choice in alternatives(one, _OTHERS)]
        with tempfile.TemporaryDirectory(prefix="ptbench-advise-") as folder:
            try:
                checked = check(program, probed, variants, backend, Path(folder), call.spp, shown=True)
            except InputError as error:
                say(f"measured, {one.decision.name}: {error}")
                code = 1
                continue
        say(f"measured, {one.decision.name}: {checked_text(checked)}")
        code |= checked.word == "not within"
    say("not checked: what is decided by error, which takes a reference image (a study of type convergence)")
    return code


def _own(one: Advised) -> set[str]:
    return {*one.decision.reference, *dict(one.pick or ())}


def checked_text(checked: Checked) -> str:
    """A sentence such as "within 5 % of the best of 4: ..."."""
    if checked.ratio is None:
        return f"{checked.word}: {checked.reason}"
    ratio = f"{figures(checked.ratio.value, 4)} {interval(checked.ratio.low, checked.ratio.high)}"
    why = f" ({checked.reason})" if checked.reason else ""
    told = f"{checked.word} {WITHIN:.0%} of the best of {checked.measured}{why}"
    return told if checked.best == checked.advised else f"{told}: {ratio} of the time of {checked.best}"
