"""Loads a result of `ptbench stability`: numerically stiff cases with exact answers, and each variant's error."""

import math
from dataclasses import dataclass, field
from pathlib import Path

from ptbench.errors import bad_value
from ptbench.io.axes import ARITHMETIC
from ptbench.io.names import shown_name, tuned_in
from ptbench.io.nodes import Node, shown
from ptbench.io.older import usual_baselines
from ptbench.io.run import OfARun

SCHEMA = "ptbench-stability-1"
PASSED, FAILED, KNOWN_LIMIT, NOT_APPLICABLE, BROKEN = STATUSES = ("passed", "failed", "known limit", "n/a", "broken")
RELATIONS = ("equal", "at most", "at least")
KINDS = ("render", "identity", "direct", "missing")
# JSON has no infinity or NaN, so that strings stand for them.
_NOT_FINITE = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}


@dataclass(frozen=True)
class Parameter:
    """A parameter of a stability case, with its value where it is not swept."""

    name: str
    standard: float
    summary: str = ""


@dataclass(frozen=True)
class Case:
    """A stability case: what makes it stiff, and where its exact value comes from."""

    name: str
    catalogue: str
    family: str
    title: str
    kind: str
    sweep: str = ""  # parameter that varies between the case's points; empty: none
    stiff: str = ""
    formula: str = ""
    missing_feature: str = ""
    parameters: dict[str, Parameter] = field(default_factory=dict, hash=False)

    @property
    def shown(self) -> str:
        """The case's number in the catalogue and its name."""
        return f"{self.catalogue} {self.name}".strip()


@dataclass(frozen=True)
class Measured:
    """A measured quantity of a case, its exact value, and the allowed error."""

    quantity: str
    relation: str
    value: float
    exact: float
    error: float
    allowed: float
    standard_error: float  # standard error of the measured value; 0: no estimate

    @property
    def over_allowed(self) -> float:
        """The error over the allowed error, good up to 1; infinite for an error where none is allowed."""
        if self.error == 0:
            return 0.0
        if self.allowed == 0 or not math.isfinite(self.error):
            return math.inf
        return self.error / self.allowed


@dataclass(frozen=True)
class Row:
    """One check of a variant at a point of a case; without `measured`, `reason` tells why."""

    case: Case
    point: tuple[tuple[str, float], ...]
    variant: str
    axes: dict[str, str] = field(hash=False)
    status: str
    must_pass: bool
    reason: str
    measured: Measured | None
    looks: int = 1

    @property
    def is_failure(self) -> bool:
        """Whether the check failed or broke."""
        return self.status in (FAILED, BROKEN)


@dataclass(frozen=True)
class Stability(OfARun):
    """The contents of one result file of `ptbench stability`."""

    path: Path
    context: dict[str, str]
    is_quick: bool
    seed: int | None
    cases: tuple[Case, ...]
    rows: tuple[Row, ...]
    paths: int | None = None  # value of --paths; 0: each case's own number of paths

    suite = "stability"

    @property
    def is_complete(self) -> bool:
        """Whether all checks of the stability run were done."""
        return self.context.get("ptbench.status", "completed") == "completed"

    @property
    def families(self) -> list[str]:
        """The cases' families, in the file's order."""
        return list(dict.fromkeys(case.family for case in self.cases))


def is_stability(root: Node) -> bool:
    """Whether a file is a stability result, the only kind of result whose file names a schema."""
    return "schema" in root.fields()


def stability_of(root: Node) -> Stability:
    """Reads and checks a result of `ptbench stability`; raises InputError."""
    root.need("schema").one_of((SCHEMA,))
    context = root.need("context")
    cases: dict[str, Case] = {}
    for node in root.need("cases").items():
        case = _case(node)
        if case.name in cases:
            raise bad_value(node.file, f"{node.place}.name", f"{shown(case.name)} again", "each name once")
        cases[case.name] = case
    quick = context.maybe("quick")
    table = root.maybe("variants")
    variants = {} if table is None else {key: _variant(table.need(key)) for key in table.fields()}
    return Stability(
        path=root.file,
        context={
            key: context.need(key).text() for key in context.fields() if key.startswith("ptbench.") or key == "date"
        },
        is_quick=quick is not None and quick.one_of((True, False)),
        seed=context.optional_integer("seed"),
        cases=tuple(cases.values()),
        rows=tuple(_row(node, cases, variants) for node in root.need("rows").items()),
        paths=context.optional_integer("paths"),
    )


def _case(node: Node) -> Case:
    parameters = node.maybe("parameters")
    return Case(
        name=node.need("name").name(),
        catalogue=node.optional_text("catalogue"),
        family=node.need("family").name(),
        title=node.optional_text("title"),
        kind=node.need("kind").one_of(KINDS),
        sweep=node.optional_text("sweep"),
        stiff=node.optional_text("stiff"),
        formula=node.optional_text("formula"),
        missing_feature=node.optional_text("missing_feature"),
        parameters={p.name: p for p in map(_parameter, parameters.items() if parameters is not None else ())},
    )


def _parameter(node: Node) -> Parameter:
    return Parameter(node.need("name").name(), node.need("standard").number(signed=True), node.optional_text("summary"))


def _variant(node: Node) -> tuple[str, dict[str, str]]:
    return node.need("variant").name(), node.need("axes").texts()


def _variant_of(row: Node, variants: dict[str, tuple[str, dict[str, str]]]) -> tuple[str, dict[str, str]]:
    """The name and choices of a row's variant: by the row's variant id, or in older files from the row itself."""
    identity = row.maybe("variant_id")
    if identity is not None:
        if identity.text() not in variants:
            raise identity.wrong("the identity of a variant in $.variants")
        return variants[identity.text()]
    axes = row.need("axes").texts()
    arithmetic = "precise" if row.optional_text("backend") == "cuda" else "exact"
    usual = usual_baselines({ARITHMETIC: arithmetic})
    return shown_name(axes, tuned_in(row.need("variant").name(), axes), usual), axes


def _row(node: Node, cases: dict[str, Case], variants: dict[str, tuple[str, dict[str, str]]]) -> Row:
    name = node.need("case")
    if name.text() not in cases:
        raise name.wrong("the name of a case in $.cases")
    point = node.need("point")
    looks = node.optional_integer("looks")
    variant, axes = _variant_of(node, variants)
    return Row(
        case=cases[name.text()],
        point=tuple((key, point.need(key).number(signed=True)) for key in point.fields()),
        variant=variant,
        axes=axes,
        status=node.need("status").one_of(STATUSES),
        must_pass=node.need("must_pass").one_of((True, False)),
        reason=node.optional_text("reason"),
        measured=None if node.maybe("quantity") is None else _measured(node),
        looks=1 if looks is None else looks,
    )


def _measured(node: Node) -> Measured:
    standard_error = node.maybe("standard_error")
    return Measured(
        quantity=node.need("quantity").name(),
        relation=node.need("relation").one_of(RELATIONS),
        value=_value(node.need("measured")),
        exact=_value(node.need("exact")),
        error=_value(node.need("error")),
        allowed=_value(node.need("allowed")),
        standard_error=0.0 if standard_error is None else _value(standard_error),
    )


def _value(node: Node) -> float:
    if isinstance(node.value, str):
        return _NOT_FINITE[node.one_of(tuple(_NOT_FINITE))]
    return node.number(signed=True)
