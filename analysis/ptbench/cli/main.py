"""The command line: `python3 -m ptbench plots|report|compare|crosscheck|peers|explain|findings|claims|...`.

Exit codes: 0 good, 1 a check failed, 2 the input or the call is wrong, 3 the machine failed.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ptbench import __version__
from ptbench.cli.parser import Parser
from ptbench.compare.options import add_compare
from ptbench.crosscheck.options import add_crosscheck
from ptbench.errors import FindingError, InputError, MachineError
from ptbench.fleet.options import add_fleet
from ptbench.io.files import package_file
from ptbench.peers.options import add_peers
from ptbench.simulate.options import add_simulate
from ptbench.submit.options import add_submit
from ptbench.terminal import OutputError, visible, visible_output
from ptbench.tidy.columns import GROUPS as TABLES

_COMMAND = "ptbench-analysis"
_MODULE = "python3 -m ptbench"


def _resolution(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if not match:
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: WIDTHxHEIGHT such as 200x200')
    return int(match[1]), int(match[2])


def _positive(text: str) -> int:
    if not re.fullmatch(r"[1-9]\d{0,8}", text):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: an integer of at least 1')
    return int(text)


def _program() -> str:
    """How it was called: as the installed command, or as a module."""
    return _COMMAND if Path(sys.argv[0]).stem == _COMMAND else _MODULE


def parser_of(program: str = _MODULE) -> argparse.ArgumentParser:
    """The whole command line; `program` is what usage and complaints call it."""
    parser = Parser(prog=program, description="Draws what ptbench measured.")
    parser.add_argument("--version", action="version", version=f"{_COMMAND} {__version__}")
    commands = parser.add_subparsers(
        dest="command",
        required=True,
        metavar="plots|report|compare|fleet|crosscheck|peers|explain|findings|claims|map|advise|gallery|flat|validate|"
        "submit|collect|simulate",
    )
    plots = commands.add_parser("plots", help="every study's figure and summary.md, from a result file alone")
    plots.add_argument("result", type=Path, metavar="RESULT.json", help="or a folder of files of `ptbench rays`")
    plots.add_argument("--out", type=Path, metavar="DIR", help="default: figures/SUITE beside the result file")
    add_compare(commands)
    add_fleet(commands)
    add_crosscheck(commands)
    add_peers(commands)
    explain = commands.add_parser("explain", help="where the time of two variants differs, and what goes with that")
    explain.add_argument("result", type=Path, metavar="RESULT.json")
    explain.add_argument("a", metavar="A", help='a variant\'s name, or parts that name one: "wavefront layout=soa"')
    explain.add_argument("b", metavar="B", help="the variant that is held against A")
    explain.add_argument("--scene", default="", help="default: every scene in which both ran")
    explain.add_argument("--depth", type=_positive, metavar="N", help="default: every depth")
    explain.add_argument("--resolution", type=_resolution, metavar="WxH", help="default: every resolution")
    explain.add_argument(
        "--counters", type=Path, action="append", default=[], metavar="INSPECT.json",
        help="what `ptbench inspect --counters --json` measured of the variants",
    )  # fmt: skip
    explain.add_argument("--out", type=Path, metavar="DIR", help="default: figures/explain-... beside the result file")
    findings = commands.add_parser(
        "findings", help="write README.md and docs/findings from docs/templates and results/ of a checkout"
    )
    findings.add_argument("names", nargs="*", metavar="PAGE", help="default: all pages and the overview")
    findings.add_argument("--check", action="store_true", help="write nothing; exit code 1 where a page does not match")
    findings.add_argument("--root", type=Path, default=Path(), metavar="DIR", help="the checkout (default: here)")
    _add_claims(commands)
    _add_map(commands)
    _add_advise(commands)
    gallery = commands.add_parser("gallery", help="render the picture pairs of a gallery file into one labelled sheet")
    gallery.add_argument("--binary", type=Path, required=True, metavar="PTBENCH")
    gallery.add_argument("--spec", type=Path, default=package_file("gallery.json"), metavar="GALLERY.json")
    gallery.add_argument("--out", type=Path, required=True, metavar="DIR")
    gallery.add_argument("--spp", type=_positive, default=64, metavar="N", help="samples per pixel (default: 64)")
    gallery.add_argument(
        "--resolution", type=_resolution, default=(200, 200), metavar="WxH", help="pixels a picture (default: 200x200)"
    )
    report = commands.add_parser("report", help="one page of one or more result files: report.html and report.md")
    report.add_argument("results", type=Path, nargs="+", metavar="RESULT", help="a result file, or a folder of some")
    report.add_argument("--out", type=Path, required=True, metavar="DIR")
    report.add_argument(
        "--binary", type=Path, metavar="PTBENCH", help="renders the scenes' pictures (default: no rendering)"
    )
    report.add_argument("--spp", type=_positive, default=16, metavar="N", help="of those pictures (default: 16)")
    report.add_argument(
        "--side", type=_positive, default=160, metavar="N", help="pixels of their longer side (default: 160)"
    )
    _add_flat(commands)
    check = commands.add_parser(
        "validate", help="hold files that ptbench wrote against their JSON Schemas, and samples against each other"
    )
    check.add_argument(
        "files", type=Path, nargs="+", metavar="FILE", help="of run, merge, stability, inspect, autotune, or a journal"
    )
    add_submit(commands)
    add_simulate(commands)
    return parser


def _add_flat(commands: argparse._SubParsersAction) -> None:
    flat = commands.add_parser("flat", help="rows of result files as one CSV or Parquet table (docs/columns.md)")
    flat.add_argument("results", type=Path, nargs="+", metavar="RESULT", help="a result file, or a folder of some")
    flat.add_argument("--out", type=Path, required=True, metavar="FILE", help=".csv, or .parquet where pyarrow is")
    flat.add_argument(
        "--table", choices=TABLES, default="", metavar="NAME",
        help=f"one of {', '.join(TABLES)} (default: samples; of files of stability and rays theirs)",
    )  # fmt: skip


def _add_claims(commands: argparse._SubParsersAction) -> None:
    claims = commands.add_parser(
        "claims", help="what published claims are found to be; exit code 1 where a committed verdict does not follow"
    )
    claims.add_argument("names", nargs="*", metavar="NAME", help="default: all claims")
    claims.add_argument("--run", action="store_true", help="measure what has no result on this machine")
    claims.add_argument("--results", type=Path, metavar="DIR", help="look up there instead (default: the checkout's)")
    claims.add_argument("--binary", type=Path, metavar="PTBENCH", help="of --run (default: build/ptbench)")
    claims.add_argument("--write", action="store_true", help="write docs/claims and its verdicts")
    claims.add_argument("--check", action="store_true", help="exit code 1 where a page of docs/claims does not match")
    claims.add_argument("--root", type=Path, default=Path(), metavar="DIR", help="the checkout (default: here)")


def _add_map(commands: argparse._SubParsersAction) -> None:
    maps = commands.add_parser("map", help="where the better of two choices changes, over two axes")
    maps.add_argument("names", nargs="*", metavar="NAME", help="default: all maps")
    maps.add_argument("--run", action="store_true", help="measure on this machine, or go on with it")
    maps.add_argument("--budget", type=_positive, metavar="S", help="seconds a map, with --run (default: the map's)")
    maps.add_argument("--results", type=Path, metavar="DIR", help="look up there instead (default: the checkout's)")
    maps.add_argument("--binary", type=Path, metavar="PTBENCH", help="of --run (default: build/ptbench)")
    maps.add_argument("--write", action="store_true", help="write docs/maps")
    maps.add_argument("--check", action="store_true", help="exit code 1 where a page of docs/maps does not match")
    maps.add_argument("--root", type=Path, default=Path(), metavar="DIR", help="the checkout (default: here)")


def _add_advise(commands: argparse._SubParsersAction) -> None:
    advise = commands.add_parser(
        "advise", help="which choices to take for a scene, what each is expected to bring, and from which measurements"
    )
    advise.add_argument("scene", metavar="SCENE", nargs="?", help="a scene's file, or its name in scenes/")
    advise.add_argument("--try", dest="tried", type=_positive, metavar="N", help="instead: try it on N made scenes")
    advise.add_argument("--seed", type=_positive, default=1, metavar="N", help="of those scenes (default: 1)")
    advise.add_argument("--loaded", action="store_true", help="try it although other processes use the machine")
    advise.add_argument("--out", type=Path, metavar="FILE", help="of --try (default: results/MACHINE/advice.json)")
    advise.add_argument("--resume", action="store_true", help="of --try: keep the decided scenes of FILE's same try")
    machine = advise.add_mutually_exclusive_group()
    machine.add_argument("--gpu", metavar="MODEL", help="a GPU of results/, such as h200 (default: this machine)")
    machine.add_argument("--cpu", action="store_true", help="ask what was measured on CPUs")
    advise.add_argument("--depth", type=_positive, metavar="N", help="default: the scene's")
    advise.add_argument("--resolution", type=_resolution, metavar="WxH", help="default: the scene's")
    advise.add_argument("--measure", action="store_true", help="run the advised choices and the next ones here")
    advise.add_argument("--spp", type=_positive, default=4, metavar="N", help="of --measure, a sample (default: 4)")
    advise.add_argument("--results", type=Path, metavar="DIR", help="ask these instead (default: the checkout's)")
    advise.add_argument("--binary", type=Path, metavar="PTBENCH", help="default: build/ptbench")
    advise.add_argument("--root", type=Path, default=Path(), metavar="DIR", help="the checkout (default: here)")


def main(arguments: list[str] | None = None, program: str = "") -> int:
    """Runs one command and returns its exit code; a wrong call ends with SystemExit(2), --help with SystemExit(0).

    `program` is what usage and complaints call it; left out, it is what the process was started as.
    """
    program = program or _program()
    with visible_output():
        try:
            with _drawing_to_files():
                code = _main(sys.argv[1:] if arguments is None else arguments, program)
            sys.stdout.flush()
        except OutputError as error:
            print(f"{program}: {error}", file=sys.stderr)
            return 3
        return code


@contextmanager
def _drawing_to_files() -> Iterator[None]:
    """matplotlib reads MPLBACKEND as soon as it is imported, and notebooks export one that only they have."""
    kept = os.environ.get("MPLBACKEND")
    os.environ["MPLBACKEND"] = "agg"
    try:
        yield
    finally:
        if kept is None:
            del os.environ["MPLBACKEND"]
        else:
            os.environ["MPLBACKEND"] = kept


@contextmanager
def _packages_of(command: str) -> Iterator[None]:
    """Round a command's imports: a package that is not there is named in one line."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise InputError(f"{command} needs the Python package {error.name} (analysis/requirements.txt)") from error


def _findings(options: argparse.Namespace) -> int:
    with _packages_of("findings"):
        from ptbench.findings.command import findings

    return findings(options.root, options.names, check=options.check)


def _peers(options: argparse.Namespace) -> int:
    # Needs neither what draws nor what checks schemas: it runs on machines that have little.
    from ptbench.peers.command import peers_command

    return peers_command(options)


def _claims(options: argparse.Namespace) -> int:
    with _packages_of("claims"):
        from ptbench.claims.command import Call, claims

    return claims(
        Call(
            options.root, tuple(options.names), options.results, options.binary,
            run=options.run, write=options.write, check=options.check,
        )
    )  # fmt: skip


def _map(options: argparse.Namespace) -> int:
    with _packages_of("map"):
        from ptbench.maps.command import Call, maps

    return maps(
        Call(
            options.root, tuple(options.names), options.results, options.binary, options.budget,
            run=options.run, write=options.write, check=options.check,
        )
    )  # fmt: skip


def _advise(options: argparse.Namespace) -> int:
    from ptbench.advise.command import Call, advise

    return advise(
        Call(
            options.scene or "", options.gpu, options.cpu, options.measure, options.depth, options.resolution,
            options.spp, options.root, options.results, options.binary, options.tried, options.seed, options.loaded,
            options.out, options.resume,
        )
    )  # fmt: skip


def _crosscheck(options: argparse.Namespace) -> int:
    from ptbench.crosscheck.command import crosscheck_command

    return crosscheck_command(options)


def _flat(options: argparse.Namespace) -> int:
    from ptbench.flat import flat

    return flat(options.results, options.out, options.table)


def _fleet(options: argparse.Namespace) -> int:
    with _packages_of("fleet"):
        from ptbench.fleet.command import fleet_command

    return fleet_command(options)


def _simulate(options: argparse.Namespace) -> int:
    with _packages_of("simulate"):
        from ptbench.simulate.command import simulate_command

    return simulate_command(options)


def _submit(options: argparse.Namespace) -> int:
    from ptbench.submit.command import submit_command

    return submit_command(options)


def _collect(options: argparse.Namespace) -> int:
    from ptbench.submit.command import collect_command

    return collect_command(options.folder)


_COMMANDS = {
    "advise": _advise,
    "claims": _claims,
    "collect": _collect,
    "crosscheck": _crosscheck,
    "findings": _findings,
    "fleet": _fleet,
    "flat": _flat,
    "map": _map,
    "peers": _peers,
    "simulate": _simulate,
    "submit": _submit,
}


def _main(arguments: list[str], program: str) -> int:
    options = parser_of(program).parse_args(arguments)
    if options.command == "validate":
        from ptbench.io.validate import validate_command

        return validate_command(options.files, program)
    if options.command == "advise" and (options.scene is None) == (options.tried is None):
        found = "both" if options.scene else "neither"
        print(f"{program} advise: found {found}, allowed: SCENE or --try N; see --help", file=sys.stderr)
        return 2
    try:
        return _COMMANDS.get(options.command, _draw)(options)
    except (InputError, FindingError) as error:
        print(f"{program}: {visible(str(error))}", file=sys.stderr)
        return 2
    except MachineError as error:
        print(f"{program}: {visible(str(error))}", file=sys.stderr)
        return 3


def _draw(options: argparse.Namespace) -> int:
    # Drawing libraries take a moment to load; a wrong call should not wait for them.
    from ptbench.compare.command import compare_command
    from ptbench.explain.command import explain
    from ptbench.explain.found import Choice
    from ptbench.gallery import gallery
    from ptbench.plots.command import plots
    from ptbench.report.command import report

    if options.command == "report":
        return report(options.results, options.out, options.binary, options.spp, options.side)
    if options.command == "plots":
        return plots(options.result, options.out)
    if options.command == "compare":
        return compare_command(options)
    if options.command == "explain":
        choice = Choice(options.scene, options.depth, options.resolution)
        return explain(options.result, options.a, options.b, choice, options.counters, options.out)
    return gallery(options.binary, options.spec, options.out, options.spp, options.resolution)
