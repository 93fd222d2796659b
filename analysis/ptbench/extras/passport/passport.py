"""A passport: the chip of a machine, and two runs of the suite `passport` on it."""

from dataclasses import dataclass
from pathlib import Path

from ptbench.errors import bad_value
from ptbench.io.cells import Result
from ptbench.io.nodes import Node, read_json
from ptbench.io.results import result_of
from ptbench.io.validate import complaints

SCHEMA = "ptbench-passport-1"


@dataclass(frozen=True)
class Passport:
    """A passport of one machine."""

    path: Path
    chip: dict  # the chip's peak rates as ptbench-passport.schema.json has them, under "cpu" and, on a GPU, "gpu"
    spp: dict[str, int]  # samples per pixel by study, which ptbench chose for the machine
    runs: tuple[Result, Result]

    @property
    def backend(self) -> str:
        """The backend that was measured: cpu or cuda."""
        return self.runs[0].context["ptbench.backend"]

    @property
    def name(self) -> str:
        """The name of the GPU or of the CPU that rendered."""
        context = self.runs[0].context
        return context["ptbench.cuda_device" if self.backend == "cuda" else "ptbench.cpu_model"]

    @property
    def is_of_one_program(self) -> bool:
        """Whether one program took both runs; a passport that was resumed may have been rebuilt in between."""
        return len({run.context.get("ptbench.program_hash") for run in self.runs}) == 1


def load_passport(path: Path) -> Passport:
    """Reads and checks a passport; raises InputError."""
    root = read_json(path)
    if root.need("schema").value != SCHEMA:
        raise bad_value(path, "$.schema", str(root.need("schema").value), SCHEMA)
    for complaint in complaints(root.value, "passport"):
        if not complaint.startswith("$.runs["):  # faults of a run are reported when it is parsed below
            place, _, rest = complaint.partition(": found ")
            found, _, allowed = rest.partition(", allowed: ")
            raise bad_value(path, place, found, allowed)
    first, second = (result_of(node) for node in root.need("runs").items())
    passport = Passport(path, root.value["chip"], root.value["spp"], (first, second))
    _check(passport, root)
    return passport


def _check(passport: Passport, root: Node) -> None:
    for number, run in enumerate(passport.runs):
        if run.suite != "passport" or run.interrupted:
            found = f"the suite {run.suite}" + (", interrupted" if run.interrupted else "")
            raise bad_value(root.file, f"$.runs[{number}]", found, "a complete run of the suite passport")
    if not passport.is_of_one_program:
        raise bad_value(root.file, "$.runs", "two programs", "two runs of one program")
