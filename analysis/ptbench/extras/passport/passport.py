"""A passport: the chip of a machine, and two runs of the suite `passport` on it."""

from dataclasses import dataclass
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.io.cells import Result
from ptbench.io.nodes import Node, read_json
from ptbench.io.results import result_of
from ptbench.io.validate import complaints


@dataclass(frozen=True)
class Passport:
    """A passport of one machine."""

    path: Path
    chip: dict  # the chip's peak rates as ptbench-passport.schema.json has them, under "cpu" and, on a GPU, "gpu"
    spp: dict[str, int]  # samples per pixel by study, which ptbench chose for the machine
    runs: tuple[Result, Result]

    @property
    def name(self) -> str:
        """The machine's name, of its GPU if that rendered, as in folders of results."""
        return self.runs[0].context["ptbench.machine"]


# Keys of a run's context that must be there, and that both runs of a passport share.
_SHARED = ("ptbench.machine", "ptbench.backend", "ptbench.threads", "ptbench.program_hash", "host_name")


def load_passport(path: Path) -> Passport:
    """Reads and checks a passport; raises InputError."""
    root = read_json(path)
    for complaint in complaints(root.value, "passport"):
        if not complaint.startswith("$.runs["):  # faults of a run are reported when it is parsed below
            raise InputError(f"{path}: {complaint}")
    first, second = (result_of(node) for node in root.need("runs").items())
    passport = Passport(path, root.value["chip"], root.value["spp"], (first, second))
    _check(passport, root)
    return passport


def _check(passport: Passport, root: Node) -> None:
    for number, run in enumerate(passport.runs):
        if run.suite != "passport" or run.interrupted:
            found = f"the suite {run.suite}" + (", interrupted" if run.interrupted else "")
            raise bad_value(root.file, f"$.runs[{number}]", found, "a complete run of the suite passport")
    first, second = (run["context"] for run in root.value["runs"])
    for key in _SHARED:
        for number, context in enumerate((first, second)):
            if key not in context:
                raise bad_value(root.file, f"$.runs[{number}].context.{key}", "nothing", "this key is required")
        if first[key] != second[key]:
            raise bad_value(root.file, f"$.runs[1].context.{key}", f'"{second[key]}"', f'"{first[key]}", as in run 0')
    if shared := set.intersection(*(_seeds(run) for run in passport.runs)):
        raise bad_value(root.file, "$.runs", f"seed {min(shared)} in both", "two runs with seeds of their own")


def _seeds(run: Result) -> set[int]:
    return {sample.seed for cell in run.cells for sample in cell.samples if sample.seed is not None}
