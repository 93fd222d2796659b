"""Error curves of a result, as a source for a page."""

from collections import Counter
from collections.abc import Callable

import numpy as np

from ptbench.convergence.assessment import Assessment, assess
from ptbench.convergence.efficiency import baseline_among, by_place, time_to
from ptbench.convergence.efficiency import compare as compare_errors
from ptbench.convergence.fit import Fit
from ptbench.errors import FindingError
from ptbench.findings.quantities import Quantity, Ratio
from ptbench.findings.suite.cells import Cells
from ptbench.stats.estimates import UNSURE, Estimate, Verdict, median_estimate, withheld, word_of
from ptbench.studies.selection import cells_of, parsed
from ptbench.studies.withdrawn import between


class Errors(Cells):
    """The bias, variance, efficiency and verdicts that the error curves of a result give."""

    def bias2(self, selection: str) -> Quantity:
        """The squared bias of a cell's image, fitted to its error curve."""
        return self._fitted(selection, lambda fit: fit.bias2)

    def sigma2(self, selection: str) -> Quantity:
        """The variance of one sample per pixel, the mean over pixels and channels."""
        return self._fitted(selection, lambda fit: fit.sigma2)

    def slope(self, selection: str) -> Quantity:
        """The log-log slope of the squared error over samples: -1 for independent samples without bias."""
        return self._fitted(selection, lambda fit: fit.slope.estimate)

    def mean_error(self, selection: str) -> Quantity:
        """The error of the image's mean (green channel) at the last checkpoint, the median over seeds."""
        cell = self.assessment(selection).cell
        last = [sample.checkpoints[-1].mean_error for sample in cell.samples]
        if not all(last):
            raise FindingError(f"{self.result.path}: no mean error: {selection}")
        return Quantity(median_estimate(np.abs([error[1] for error in last if error])), cell.name)

    def wall(self, selection: str) -> Quantity:
        """Render wall time per sample per pixel with checkpoints, ms."""
        one = self.assessment(selection)
        return Quantity(one.ms_per_spp["wall_ms"], one.cell.name)

    def wall_alone(self, selection: str) -> Quantity:
        """Render wall time per sample per pixel of the companion cell without checkpoints, ms."""
        one = self.assessment(selection)
        if one.ms_alone is None:
            raise FindingError(f"{self.result.path}: not run without checkpoints: {selection}")
        return Quantity(median_estimate(one.ms_alone), one.cell.name)

    def verdicts(self) -> Counter:
        """The number of convergence cells by verdict: converges, plateau, ..."""
        return Counter(one.verdict.word for one in assess(self.result).values())

    def efficiency(self, selection: str, base_at: str = "") -> Ratio:
        """The efficiency of a cell against the one that `base_at` selects, or its scene's baseline; FASTER: > 1.

        The baseline is that of the study which the selection names.
        """
        one = self.assessment(selection)
        base = self.assessment(base_at) if base_at else self._baseline(one, self._chosen(selection)["study"])
        compared = compare_errors(one, base)
        if compared is None or compared.efficiency is None or base is None:
            raise FindingError(f"{self.result.path}: no efficiency: {selection}")
        if between(one.cell, base.cell):
            raise FindingError(f"{one.cell.name}: its efficiency is withdrawn (analysis/withdrawn.json)")
        value = compared.efficiency
        # A higher efficiency means less time at equal error, so its reciprocal is judged like a ratio of times.
        word = UNSURE if value.low is None or value.high is None else word_of(1 / value.high, 1 / value.low)
        verdict = withheld(Verdict(word), compared.doubt) if compared.doubt else Verdict(word)
        return Ratio(value, verdict, one.cell.name)

    def _baseline(self, one: Assessment, study: str) -> Assessment | None:
        members = [other for other in assess(self.result).values() if study in other.cell.studies]
        return baseline_among(self.result, next(group for group in by_place(members).values() if one in group))

    def must_stop_above(self, selection: str, error: float) -> str:
        """Returns an empty text if a plateau above `error` was found; otherwise raises FindingError."""
        plateau = self.assessment(selection).verdict.plateau
        if plateau is None or plateau <= error:
            raise FindingError(f"{self.result.path}: no plateau above {error}, as the page says: {selection}")
        return ""

    def ms_to(self, selection: str, error: float) -> Quantity:
        """Wall time of a render in one piece until its RMS error is `error`, ms (convergence/efficiency.py)."""
        one = self.assessment(selection)
        time = time_to(one, error)
        if time is None:
            raise FindingError(f"{self.result.path}: no time to {error}: {selection}")
        return Quantity(time, one.cell.name)

    def assessment(self, selection: str, over: str = "") -> Assessment:
        """The error curve of the one cell of a selection, modified by the words of `over`."""
        found = cells_of(self.result, {**self._chosen(selection), **parsed(over)})
        assessed = assess(self.result)
        named = [assessed[cell.name] for cell in found if cell.name in assessed]
        if len(named) != 1:
            raise FindingError(f"{self.result.path}: {len(named)} error curves: {selection} {over}")
        return named[0]

    def _fitted(self, selection: str, value: Callable[[Fit], Estimate]) -> Quantity:
        one = self.assessment(selection)
        if one.fit is None:
            raise FindingError(f"{self.result.path}: no fit: {selection}")
        return Quantity(value(one.fit), one.cell.name)
