"""Formats numbers for readers: significant digits, intervals, ratios, ranges, counts."""

from collections.abc import Iterable


def figures(value: float, digits: int = 4) -> str:
    """A number with `digits` significant digits, in powers of ten only where unavoidable."""
    if value == 0:
        return "0"
    if abs(value) >= 10 ** (digits - 1):
        return f"{value:.0f}"
    return f"{value:#.{digits}g}".rstrip(".") if abs(value) >= 1e-4 else f"{value:.{digits - 1}e}"


def plural(count: int | str, what: str) -> str:
    """A count with its noun, "1 cell" or "2 cells"; the count may be text."""
    return f"{count} {what}{'' if str(count) == '1' else 's'}"


def interval(low: float | None, high: float | None, digits: int = 4) -> str:
    """An interval as text, "[low, high]" with `digits` significant digits."""
    return "no interval" if low is None or high is None else f"[{figures(low, digits)}, {figures(high, digits)}]"


def ratio(value: float) -> str:
    """A ratio with three decimals, or two from 10 on."""
    return f"{value:.3f}" if abs(value) < 10 else f"{value:.2f}"


def share(value: float | None) -> str:
    """A fraction as a percentage, "47 %"; a dash where there is no value."""
    return "—" if value is None else f"{figures(100 * value, 2)} %"


def percent(share: float) -> str:
    """A fraction as pages show it, "95 %"."""
    return f"{share:.0%}".replace("%", " %")


def span(values: Iterable[int], unit: str = "") -> str:
    """The range of the values of a setting, "4" or "1 to 8"."""
    ordered = sorted(set(values))
    text = str(ordered[0]) if len(ordered) == 1 else f"{ordered[0]} to {ordered[-1]}"
    return f"{text} {unit}".strip()


def count(value: float) -> str:
    """A count in few characters: 950, 12.3k, 150k, 2.50M."""
    if value >= 1e6:
        return f"{value / 1e6:.2f}M"
    return f"{value / 1e3:.0f}k" if value >= 1e5 else f"{value / 1e3:.1f}k" if value >= 1e4 else f"{value:.0f}"
