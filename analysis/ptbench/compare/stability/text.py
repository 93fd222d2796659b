"""The findings of `compare` on stability files: in words and tables, and as JSON."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence

from ptbench.compare.match import MACHINE_KEYS, PROGRAM_KEYS
from ptbench.compare.stability.matching import Against, Pair, StabilityCompared
from ptbench.compare.text import MARKS, device_of, differing
from ptbench.document.blocks import Section, section
from ptbench.document.table import table_of
from ptbench.io.axes import ARITHMETIC
from ptbench.io.files import one_line, picked
from ptbench.io.stability import BROKEN, FAILED, KNOWN_LIMIT, NOT_APPLICABLE, PASSED, Row, Stability
from ptbench.stability.layout import Layout, point_label, short_power

SCHEMA_VERSION = "1"
MUST_PASS, NEED_NOT_PASS = "failed that must pass", "failed that need not pass"
TALLIES = (PASSED, MUST_PASS, BROKEN, KNOWN_LIMIT, NEED_NOT_PASS, NOT_APPLICABLE)
_SHOWN = 40  # largest number of changed stability checks that stdout lists
_NAMED = 8  # largest number of stability cases that one sentence names


def stability_sections(compared: StabilityCompared, whole: bool) -> list[Section]:
    """The report on stability files; `whole` lists every changed row."""
    found = [_files(compared.files)]
    for mark, against in zip(MARKS[1:], compared.comparisons, strict=False):
        found.append(_tallies(against, mark))
        found += [section for section in (_families(against, mark), _changes(against, mark, whole)) if section]
        if against.alone:
            found.append(_alone(against, mark))
    return found


def _files(files: Sequence[Stability]) -> Section:
    rows = [
        (
            mark,
            str(file.path),
            file.about("machine"),
            file.about("backend"),
            device_of(file),
            file.about("git_sha")[:12] + (" (dirty)" if file.git.endswith("(dirty)") else ""),
            file.context.get("date") or "no date",
            file.about("status"),
            {"true": "yes", "false": "no"}.get(file.about("cuda_mps"), "not told"),
            str(len(file.rows)),
        )
        for mark, file in zip(MARKS, files, strict=False)
    ]
    columns = ("", "File", "Machine", "Backend", "Device", "git", "Date", "Status", "MPS", "Rows")
    else_differs = [line for key in (*MACHINE_KEYS, *PROGRAM_KEYS) if (line := differing(key, files))]
    for key, said in (
        ("quick", [str(file.is_quick).lower() for file in files]),
        ("seed", [str(file.seed) for file in files]),
        ("paths", [str(file.paths) for file in files]),
    ):
        if len(set(said)) > 1:
            else_differs.append(f"{key}: " + "; ".join(map(" ".join, zip(MARKS, said, strict=False))))
    after = ("What else differs between the files:", *else_differs) if else_differs else ()
    return section("Files", (), table_of(columns, rows, {"Rows"}), after)


def _tallied(rows: Iterable[Row]) -> Counter:
    return Counter(
        (MUST_PASS if row.must_pass else NEED_NOT_PASS) if row.status == FAILED else row.status for row in rows
    )


def _tallies(against: Against, mark: str) -> Section:
    alone = Counter(in_reference for in_reference, _ in against.alone)
    lines = [
        f"{len(against.pairs)} rows (case, point, quantity, variant) are in both; {alone[True]} are in A alone, "
        f"{alone[False]} in {mark} alone.",
        f"Another status have {len(against.changed)}; of what must pass {len(against.newly_failed)} fail in {mark} "
        "that did not in A.",
        *_numbers(against),
    ]
    one, other = _tallied(against.reference.rows), _tallied(against.other.rows)
    changes = {what: other[what] - one[what] for what in TALLIES}
    table = tuple((what, str(one[what]), str(other[what]), f"{by:+d}" if by else "0") for what, by in changes.items())
    columns = ("Rows", "A", mark, "Change")
    return section(f"{mark} against A", tuple(lines), table_of(columns, table, columns[1:]))


def _numbers(against: Against) -> Iterable[str]:
    """Sentences on how the measured numbers changed in rows of equal status."""
    same, moved = against.numbers, against.moved
    exact = [pair for pair in same if pair.one.axes.get(ARITHMETIC) == "exact"]
    moved_in_exact = sum(not pair.has_same_value for pair in exact)
    yield (
        f"Of {len(same)} rows with numbers and the same status {len(same) - len(moved)} measured the same value bit "
        f"for bit; in exact arithmetic {len(exact) - moved_in_exact} of {len(exact)}."
    )
    if moved:
        largest = max(moved, key=lambda pair: pair.relative_change)
        yield (
            f"The other {len(moved)} are of {_names(pair.one for pair in moved)}; the largest change is "
            f"{_number(largest.relative_change)} of the larger value ({_where(largest.one)}: {_quantity(largest)})."
        )
    if asked := [pair for pair in same if pair.has_another_check]:
        yield (
            f"The exact value or what is allowed is another in {len(asked)} of these rows, of "
            f"{_names(pair.one for pair in asked)}."
        )


def _names(rows: Iterable[Row]) -> str:
    names = list(dict.fromkeys(row.case.shown for row in rows))
    rest = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {rest} more" if rest > 0 else "")


def _where(row: Row) -> str:
    return f"{row.case.shown} {point_label(row.case, row.point)}".strip()


def _number(value: float) -> str:
    return short_power(f"{value:.3g}")


def _families(against: Against, mark: str) -> Section | None:
    rows = []
    for family in dict.fromkeys([*against.reference.families, *against.other.families]):
        one, other = (
            _tallied(row for row in file.rows if row.case.family == family)
            for file in (against.reference, against.other)
        )
        if one != other:
            numbers = (
                str(one[what]) if one[what] == other[what] else f"{one[what]} → {other[what]}" for what in TALLIES
            )
            rows.append((family, *numbers))
    if not rows:
        return None
    columns = ("Family", *TALLIES)
    heading = f"Families whose tallies differ, A → {mark}"
    return section(heading, (), table_of(columns, rows, TALLIES))


def _changes(against: Against, mark: str, whole: bool) -> Section | None:
    if not against.changed:
        return None
    layout = Layout(against.reference)
    shown = against.changed if whole else against.changed[:_SHOWN]
    rows = tuple(
        (
            pair.one.case.shown,
            point_label(pair.one.case, pair.one.point) or "—",
            " ".join(part for part in (layout.column_of(pair.one), layout.place_of(pair.one).estimator) if part),
            _quantity(pair),
            _status(pair.one, pair),
            _status(pair.other, pair),
            *(_measured(row, "error") for row in (pair.one, pair.other)),
            *(_measured(row, "allowed") for row in (pair.one, pair.other)),
            _reason(pair, mark),
        )
        for pair in shown
    )
    numeric = ("Error A", f"Error {mark}", "Allowed A", f"Allowed {mark}")
    columns = ("Case", "Point", "Variant", "Quantity", "A", mark, *numeric, "Reason")
    rest = len(against.changed) - len(shown)
    after = (f"And {rest} more rows (--out and --json have all).",) if rest else ()
    return section(f"Rows of another status, {mark} against A", (), table_of(columns, rows, numeric), after)


def _quantity(pair: Pair) -> str:
    return next((row.measured.quantity for row in (pair.one, pair.other) if row.measured is not None), "—")


def _status(row: Row, pair: Pair) -> str:
    if not row.is_failure and pair.one.must_pass == pair.other.must_pass:
        return row.status
    return f"{row.status} ({'must pass' if row.must_pass else 'need not pass'})"


def _measured(row: Row, what: str) -> str:
    if row.measured is None or row.status == NOT_APPLICABLE:
        return "—"
    return _number(getattr(row.measured, what))


def _reason(pair: Pair, mark: str) -> str:
    one, other = one_line(pair.one.reason), one_line(pair.other.reason)
    if one == other:
        return one or "—"
    return " ".join(f"{of}: {text}" for of, text in (("A", one), (mark, other)) if text)


def _alone(against: Against, mark: str) -> Section:
    counts = Counter((row.case.shown, in_reference) for in_reference, row in against.alone)
    rows = tuple(
        (case, str(counts[case, True]), str(counts[case, False])) for case in dict.fromkeys(case for case, _ in counts)
    )
    columns = ("Case", "A alone", f"{mark} alone")
    return section(f"Rows that only one of A and {mark} has", (), table_of(columns, rows, columns[1:]))


def stability_json(compared: StabilityCompared) -> dict:
    """A comparison of stability files as JSON, in which files are named by their index in "files"."""
    return {
        "schema": "ptbench.compare_stability",
        "schema_version": SCHEMA_VERSION,
        "files": [
            {
                "path": str(file.path),
                "machine": file.about("machine"),
                "backend": file.about("backend"),
                "git": file.git,
                "program_hash": file.about("program_hash"),
                "date": file.context.get("date", ""),
                "status": file.about("status"),
                "mps": file.about("cuda_mps"),
                "rows": len(file.rows),
                "tallies": _whole_tally(file.rows),
                "families": {
                    family: _whole_tally([row for row in file.rows if row.case.family == family])
                    for family in file.families
                },
            }
            for file in compared.files
        ],
        "comparisons": [_against_json(index, one) for index, one in enumerate(compared.comparisons, 1)],
    }


def _whole_tally(rows: Sequence[Row]) -> dict[str, int]:
    found = _tallied(rows)
    return {what: found[what] for what in TALLIES}


def _against_json(index: int, against: Against) -> dict:
    exact = [pair for pair in against.numbers if pair.one.axes.get(ARITHMETIC) == "exact"]
    return {
        "reference": 0,
        "other": index,
        "pairs": len(against.pairs),
        "newly_failed": len(against.newly_failed),
        "changed": [
            {**_identity_json(pair.one), "quantity": _quantity(pair)}
            | {"reference": _row_json(pair.one), "other": _row_json(pair.other)}
            for pair in against.changed
        ],
        "same_status": {
            "with_numbers": len(against.numbers),
            "bit_identical": len(against.numbers) - len(against.moved),
            "with_numbers_exact": len(exact),
            "bit_identical_exact": sum(pair.has_same_value for pair in exact),
            "largest_relative_change": _json_number(max((pair.relative_change for pair in against.moved), default=0.0)),
            "another_check": sum(pair.has_another_check for pair in against.numbers),
        },
        "alone": [
            {"of": "reference" if in_reference else "other", **_identity_json(row), **_row_json(row)}
            for in_reference, row in against.alone
        ],
    }


def _identity_json(row: Row) -> dict:
    return {"case": row.case.name, "point": dict(row.point), "variant": row.variant}


def _row_json(row: Row) -> dict:
    found = picked(row, "status must_pass reason")
    if row.measured is None:
        return found
    numbers = {"measured": row.measured.value, "exact": row.measured.exact}
    numbers |= {"error": row.measured.error, "allowed": row.measured.allowed}
    return {**found, "quantity": row.measured.quantity} | {key: _json_number(one) for key, one in numbers.items()}


def _json_number(value: float) -> float | str:
    return value if math.isfinite(value) else f"{value:g}"
