"""Result files compared with the first of them: all findings of one comparison, before they are put into words."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ptbench.compare.match import Matching, machine_of, match
from ptbench.compare.noise import Floor, Repeat, check_noise_files, floor_of, repeats_of
from ptbench.compare.ranking import Ranking, rankings
from ptbench.compare.text import MARKS, Labels, labels_of
from ptbench.compare.verdicts import Comparison, compare
from ptbench.errors import InputError
from ptbench.io.cells import Result
from ptbench.io.nodes import read_json
from ptbench.io.results import load_kept
from ptbench.io.stability import is_stability
from ptbench.stats.estimates import THRESHOLD


@dataclass(frozen=True)
class Compared:
    """Everything that one call of `compare` found."""

    results: tuple[Result, ...]
    comparisons: tuple[Comparison, ...]
    repeats: tuple[Repeat, ...]
    floors: tuple[Floor, ...]  # noise floors, one per machine with an A/A run
    rankings: tuple[Ranking, ...]
    ranked: tuple[str, ...]  # letters (A, B, ..) of the compared files that rankings of variants include
    labels: Labels

    def marks_of(self, comparison: Comparison) -> tuple[str, str]:
        """The letters that name the reference and the other file of a comparison."""
        return MARKS[0], MARKS[next(i for i, result in enumerate(self.results) if result is comparison.other)]


def check_number(paths: Sequence[Path]) -> None:
    """Raises InputError unless at least two files are given, and no more than there are letters."""
    if len(paths) < 2:
        raise InputError(f"{paths[0]}: found one result file, allowed: two or more to compare")
    if len(paths) > len(MARKS):
        raise InputError(f"{paths[-1]}: found {len(paths)} result files, allowed: at most {len(MARKS)}")


def compare_files(paths: Sequence[Path], noise: Sequence[Path] = (), *, films_may_differ: bool = False) -> Compared:
    """Loads the result files and compares them; raises InputError."""
    check_number(paths)
    results = [_load(path) for path in paths]
    noise_results = [_load(path) for path in noise]
    check_noise_files(noise_results, results)
    matchings = [match(results[0], other, films_may_differ=films_may_differ) for other in results[1:]]
    for matching in matchings:
        _refuse_strangers(matching)
    repeats = repeats_of([*results, *noise_results])
    comparisons = [_judged(matching, repeats) for matching in matchings]

    def threshold(result: Result) -> float:
        # Two cells of one run differ by less than two runs do, so the noise floor between runs is a safe threshold.
        floor = floor_of(result, repeats)
        return THRESHOLD if floor is None else floor.threshold

    # A repeated run of the reference's program shows only noise, so it takes no part in the ranking of variants.
    ranked = [index for index, one in enumerate(comparisons) if not one.repeated] or list(range(len(comparisons)))
    return Compared(
        tuple(results),
        tuple(comparisons),
        tuple(repeats),
        _floors([*results, *noise_results], repeats),
        tuple(rankings([matchings[index] for index in ranked], threshold)),
        (MARKS[0], *(MARKS[index + 1] for index in ranked)),
        labels_of(matchings),
    )


def _load(path: Path) -> Result:
    try:
        return load_kept(path)
    except InputError:
        if is_stability(read_json(path)):
            allowed = "a result file of `ptbench run`"
            raise InputError(f"{path}: found a file of `ptbench stability`, allowed: {allowed}") from None
        raise


def _refuse_strangers(matching: Matching) -> None:
    if matching.pairs:
        return
    kinds = Counter(item.kind for item in matching.alone if item.in_reference)
    why = ", ".join(f"{kind} {count}" for kind, count in kinds.most_common()) or "no cells"
    raise InputError(
        f"{matching.other.path}: found no cell to hold against one of {matching.reference.path} ({why}), "
        "allowed: files that measured some work in common"
    )


def _judged(matching: Matching, repeats: Sequence[Repeat]) -> Comparison:
    sides = (matching.reference, matching.other)
    return compare(matching, _floors(sides, repeats, without=sides))


def _floors(results: Sequence[Result], repeats: Sequence[Repeat], without: Sequence[Result] = ()) -> tuple[Floor, ...]:
    """The noise floors of the machines of the result files, each machine once."""
    machines = {machine_of(result): result for result in results}
    found = (floor_of(result, repeats, without) for result in machines.values())
    return tuple(floor for floor in found if floor is not None)
