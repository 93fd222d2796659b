"""A suite on several GPU models, with the predicted time of each cell and the error of the prediction."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ptbench.compare.compared import Compared, compare_files
from ptbench.compare.verdicts import Comparison, Row
from ptbench.extras.fleet.evidence import OWN, Evidence, check_gpu, evidence_of
from ptbench.extras.fleet.gpus import Gpu, gpu_of_result, gpu_of_sheet
from ptbench.extras.fleet.model import RULES, USED, Rule, bound_of, predicted
from ptbench.io.cells import Cell
from ptbench.io.inspection import Inspected, load_inspected

NEAR_ENOUGH = 0.05  # relative error up to which a predicted time ratio counts as right
BAR = 0.9  # least share of variants with a right prediction of the time ratio for the rule to reach its aim


@dataclass(frozen=True)
class Prediction:
    """The prediction for a cell on another GPU; ratios are its time there over that on the first GPU."""

    row: Row
    evidence: Evidence
    bound: str
    shares: dict[str, float]
    ratios: dict[str, float]  # predicted time on the other GPU over that on the first, by name of the prediction rule

    @property
    def cell(self) -> Cell:
        """The cell as measured on the first GPU."""
        return self.row.pair.reference

    @property
    def is_own(self) -> bool:
        """Whether the counters are of the cell's own variant and render."""
        return self.evidence.kind == OWN

    def error(self, rule: Rule = USED) -> float:
        """The relative error of the predicted time ratio."""
        return self.ratios[rule.name] / self.row.ratio.value - 1


@dataclass(frozen=True)
class Score:
    """How well a rule predicts time ratios."""

    rule: Rule
    count: int
    within: int
    mean: float  # mean absolute relative error of the predicted time ratios
    worst: float  # largest relative error of a predicted time ratio, with its sign

    @property
    def share(self) -> float:
        """The share of variants whose prediction is within the accepted error."""
        return self.within / self.count


@dataclass(frozen=True)
class Other:
    """Another GPU of the fleet compared with the first; `rows` without counters have no prediction."""

    gpu: Gpu
    comparison: Comparison
    predictions: tuple[Prediction, ...]
    unpredicted: tuple[Row, ...]

    def scores(self, *, own: bool, without: str = "") -> list[Score]:
        """Scores of every rule, over cells with their own counters or with any; empty where there are none.

        `without` names a scene that is excluded.
        """
        chosen = [one for one in self.predictions if (one.is_own or not own) and one.cell.scene != without]
        return [_score(rule, chosen) for rule in RULES] if chosen else []


@dataclass(frozen=True)
class Unowned:
    """A GPU that nobody measured, with predictions from its data sheet."""

    gpu: Gpu
    ratios: dict[str, float]  # predicted time ratio by cell name; only cells with hardware counters of their own


@dataclass(frozen=True)
class Fleet:
    """Everything that `fleet` reports."""

    compared: Compared
    first: Gpu
    others: tuple[Other, ...]
    unowned: tuple[Unowned, ...]
    static: tuple[Inspected, ...]
    evidence: dict[str, Evidence] = field(default_factory=dict)  # counters of the first file's cells, by cell name


def fleet_of(results: Sequence[Path], inspected: Sequence[Path], models: Sequence[str] = ()) -> Fleet:
    """Loads, compares and predicts; the counters are of the first result file's GPU. Raises InputError."""
    compared = compare_files(results)
    first = gpu_of_result(compared.results[0])
    entries = [entry for path in inspected for entry in load_inspected(path)]
    counted = [entry for entry in entries if entry.ceilings]
    check_gpu(counted, first, str(results[0]))
    cells = [cell for cell in compared.results[0].cells if cell.measured]
    found = {cell.name: evidence for cell in cells if (evidence := evidence_of(cell, counted)) is not None}
    return Fleet(
        compared,
        first,
        tuple(_other(comparison, first, found) for comparison in compared.comparisons),
        tuple(_unowned(gpu_of_sheet(model), first, cells, found) for model in models),
        tuple(entry for entry in entries if not entry.ceilings),
        found,
    )


def _other(comparison: Comparison, first: Gpu, found: dict[str, Evidence]) -> Other:
    gpu = gpu_of_result(comparison.other)
    with_counters = [row for row in comparison.rows if row.pair.reference.name in found]
    return Other(
        gpu,
        comparison,
        tuple(_prediction(row, found[row.pair.reference.name], first, gpu) for row in with_counters),
        tuple(row for row in comparison.rows if row.pair.reference.name not in found),
    )


def _prediction(row: Row, evidence: Evidence, first: Gpu, gpu: Gpu) -> Prediction:
    ratio_by = _ratio_by(row.pair.reference, evidence, first, gpu)
    return Prediction(row, evidence, *bound_of(evidence.kernels), {rule.name: ratio_by(rule) for rule in RULES})


def _unowned(gpu: Gpu, first: Gpu, cells: Sequence[Cell], found: dict[str, Evidence]) -> Unowned:
    chosen = [cell for cell in cells if cell.name in found and found[cell.name].kind == OWN]
    return Unowned(gpu, {cell.name: _ratio_by(cell, found[cell.name], first, gpu)(USED) for cell in chosen})


def _ratio_by(cell: Cell, evidence: Evidence, first: Gpu, gpu: Gpu) -> Callable[[Rule], float]:
    device = cell.device_share
    return lambda rule: predicted(evidence.kernels, 1.0 if device is None else min(1.0, device), first, gpu, rule)


def _score(rule: Rule, predictions: Sequence[Prediction]) -> Score:
    errors = [one.error(rule) for one in predictions]
    sizes = [abs(error) for error in errors]
    return Score(
        rule,
        len(errors),
        sum(size <= NEAR_ENOUGH for size in sizes),
        sum(sizes) / len(sizes),
        max(errors, key=abs),
    )
