"""`claims`: runs or looks up each claim's experiment, prints the verdicts and compares them with the committed ones."""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from ptbench.claims.claim import Claim, Ledger
from ptbench.claims.evidence import evidence_of
from ptbench.claims.history import UNKNOWN, Order, order_of
from ptbench.claims.judging import judge
from ptbench.claims.pages import Told, measured_text, pages_of, span_text, word_text
from ptbench.errors import FindingError
from ptbench.findings.ledger import Call, stale_pages, write_pages
from ptbench.io.nodes import read_json


def claims(call: Call) -> int:
    """Runs `claims`; exit code 0: every committed verdict follows from its data, 1: one does not, or a run failed."""
    ledger = Ledger(call.root)
    chosen = ledger.claims(call.names)
    results = call.folder
    if call.run:
        _run(call, ledger, chosen)
    recorded = _recorded(ledger)
    told = [one for claim in chosen for one in told_of(ledger, claim, results, recorded)]
    for one in told:
        _say(one, detailed=bool(call.names))
    if call.results is not None:  # verdicts are committed, and thus checked, only for the checkout's own results/
        return 0
    faults = [] if call.write else _contradictions(told, recorded, chosen)
    everything = (
        told
        if not call.names
        else [one for claim in ledger.claims() for one in told_of(ledger, claim, results, recorded)]
    )
    try:
        if call.write:
            pages = pages_of(ledger, everything)
            pages[ledger.verdicts.name] = json.dumps(_record(everything), indent=1, ensure_ascii=False) + "\n"
            write_pages(ledger.pages, pages)
            print(f"{ledger.pages}: {len(pages)} files")
        elif call.check:
            pages = pages_of(ledger, _committed(everything, recorded))
            faults += stale_pages(ledger.pages, pages, "claim", "claims")
    except FindingError as error:
        faults.append(str(error))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


def told_of(ledger: Ledger, claim: Claim, results: Path, recorded: Mapping) -> list[Told]:
    """The verdicts on a claim, one for every machine with a result; `recorded`: the committed verdicts."""
    evidence = evidence_of(claim, results)
    if not evidence:
        return [Told(claim, judge(claim, None))]
    told = []
    for one in evidence:
        order = order_of(ledger, claim, one.machine, one.measured)
        kept = recorded.get(claim.name, {}).get(one.machine, {}).get("order")
        if order.grade == UNKNOWN and kept is not None:  # without git, the order is that of the committed verdict
            order = Order(**kept)
        told.append(Told(claim, judge(claim, one), one, order))
    return told


def _say(one: Told, *, detailed: bool) -> None:
    where = f" on {one.device}" if one.evidence is not None else ""
    print(f"{one.claim.name}: {one.word}{where} ({one.verdict.reason})")
    if one.order is not None:
        print(f"  {one.order.said}; predicted right: {one.foreseen}")
    if detailed:
        for row in one.verdict.judged:
            condition = row.found.condition
            print(
                f"  {condition.name}: {measured_text(row)}, claim {span_text(condition.claimed)}, "
                f"predicted {span_text(condition.predicted)}: {word_text(row)}"
            )


def _recorded(ledger: Ledger) -> dict:
    """The committed verdicts: by claim, then by machine."""
    return read_json(ledger.verdicts).fields() if ledger.verdicts.is_file() else {}


def _record(told: Sequence[Told]) -> dict:
    record: dict[str, dict] = {}
    for one in told:
        if one.evidence is not None and one.order is not None:
            record.setdefault(one.claim.name, {})[one.machine] = {
                "verdict": one.verdict.word,
                "holds": one.verdict.held,
                "results": list(one.files),
                "order": one.order.document(),
            }
    return record


def _contradictions(told: Sequence[Told], recorded: Mapping, chosen: Sequence[Claim]) -> list[str]:
    """The committed verdicts that do not follow from the results; results without a committed verdict are ignored."""
    now = _record(told)
    faults = []
    for claim in chosen:
        for machine, before in recorded.get(claim.name, {}).items():
            after = now.get(claim.name, {}).get(machine)
            where = f"{claim.name} on {machine}"
            if after is None:
                faults.append(
                    f"{where}: {before['verdict']} is committed, and its data are gone ({', '.join(before['results'])})"
                )
            elif (after["verdict"], after["holds"]) != (before["verdict"], before["holds"]):
                faults.append(f"{where}: {before['verdict']} is committed, its data say {after['verdict']}")
            elif after["order"]["grade"] != before["order"]["grade"]:
                faults.append(f"{where}: committed as {before['order']['grade']}, git says {after['order']['grade']}")
    return faults


def _committed(told: Sequence[Told], recorded: Mapping) -> list[Told]:
    """Verdicts without the machines that have no committed verdict: a user's own measurements change no page."""
    kept: list[Told] = []
    for claim in dict.fromkeys(one.claim.name for one in told):
        own = [one for one in told if one.claim.name == claim]
        known = [one for one in own if one.machine in recorded.get(claim, {})]
        kept += known or [Told(own[0].claim, judge(own[0].claim, None))]
    return kept


def _run(call: Call, ledger: Ledger, chosen: Sequence[Claim]) -> None:
    """Runs each experiment that has no result on this machine yet; raises InputError where one fails."""
    program = call.program
    machine = program.machine()
    done = set()
    for claim in chosen:
        experiment = claim.experiment
        if experiment is None or experiment.result in done:
            continue
        done.add(experiment.result)
        out = call.folder / machine / "claims" / f"{experiment.result}.json"
        if out.exists() or Path(f"{out}.gz").exists():
            print(f"{out}: is there")
            continue
        out.parent.mkdir(parents=True, exist_ok=True)
        if experiment.rays:
            arguments = ["rays", *experiment.rays]
        else:
            # A claim's suite runs untuned, as predicted, even where `autotune` found better parameters on this machine.
            arguments = ["run", "--suite", str(ledger.suite(experiment.suite)), "--resume", "--untuned"]
        print(f"{experiment.result}: about {experiment.seconds} s", flush=True)
        program.watched(*arguments, "--backend", experiment.backend, "--out", out, output=sys.stderr)
