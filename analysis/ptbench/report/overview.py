"""The sections of a report on all of its files: machines, runs, omissions, scenes, method, raw rows."""

from collections.abc import Sequence
from pathlib import Path

from ptbench.convergence.assessment import RULES
from ptbench.convergence.efficiency import EFFICIENCY_RULE
from ptbench.document.blocks import Block, Bullets, Facts, Heading, Paragraph, Pictures, Section, anchor_of, shown_table
from ptbench.document.table import table_of
from ptbench.io.files import one_line
from ptbench.numbers import plural
from ptbench.plots.summary import GPU_TEXT
from ptbench.report.chapter import Chapter
from ptbench.report.scenes import ScenePicture
from ptbench.stability.summary import RULE as STABILITY_RULE
from ptbench.stats.estimates import INTERVAL_TEXT, VERDICT_RULE

NO_PICTURES = (
    "Scenes without a picture can be rendered for this page: give the command `--binary build/ptbench`. "
    "A convergence study with `images` leaves its references beside the result file; those are shown without it."
)


def report_sections(
    chapters: Sequence[Chapter], pictures: Sequence[ScenePicture], passed_over: Sequence[Path]
) -> list[Section]:
    """The sections of the report, in order: the findings, their doubts, all details, and the method."""
    return [
        _findings(chapters),
        Section("At a glance", "glance", tuple(_glance(chapters))),
        Section("What was left out, and why", "left-out", tuple(_left_out(chapters))),
        Section("Results", "results", (), tuple(chapter.section for chapter in chapters)),
        Section("Scenes", "scenes", tuple(_scenes(chapters, pictures))),
        Section("Machines", "machines", tuple(_machines(chapters))),
        Section("What ran", "what-ran", tuple(_what_ran(chapters, passed_over))),
        Section("Method", "method", tuple(_method(chapters))),
        Section("Raw rows", "raw", tuple(_raw(chapters))),
    ]


def _listed(values: Sequence[str]) -> str:
    return ", ".join(f"`{value}`" for value in dict.fromkeys(values))


def _findings(chapters: Sequence[Chapter]) -> Section:
    """The section on what each file found, preceded by warnings."""
    warnings = _warnings(chapters)
    blocks: list[Block] = [Bullets(tuple(warnings))] if warnings else []
    if len(chapters) == 1:
        return Section("What was found", "findings", (*blocks, *chapters[0].findings))
    parts = tuple(
        Section(chapter.title, anchor_of("findings", chapter.title), chapter.findings) for chapter in chapters
    )
    return Section("What was found", "findings", tuple(blocks), parts)


def _warnings(chapters: Sequence[Chapter]) -> list[str]:
    warnings = []
    for chapter in chapters:
        if chapter.status != "completed":
            warnings.append(f"**{chapter.title}**: the run is not complete ({chapter.status}).")
        if chapter.dirty in ("true", "1"):
            warnings.append(f"**{chapter.title}**: built with uncommitted changes: the commit does not say what ran.")
        if chapter.counts.failed:
            warnings.append(f"**{chapter.title}**: {chapter.counts.failed} failed.")
    return warnings


def _glance(chapters: Sequence[Chapter]) -> list[Block]:
    machines = list(dict.fromkeys(chapter.machine for chapter in chapters))
    commits = list(dict.fromkeys(chapter.git_sha for chapter in chapters))
    text = f"{plural(len(chapters), 'result file')}, from {plural(len(machines), 'machine')} ({_listed(machines)})"
    text += f" and {plural(len(commits), 'commit')} of ptbench ({_listed([commit[:10] for commit in commits])})."
    if len(machines) > 1 or len(commits) > 1:
        text += " Every comparison on this page is within one file; nothing is compared across machines or commits."
    head = ("File", "Machine", "Backend", "Measured", "Failed", "n/a", "Samples", "Disturbed", "Verdicts")
    rows = [
        (
            chapter.title,
            chapter.machine,
            chapter.backend,
            chapter.counts.measured,
            str(chapter.counts.failed),
            str(chapter.counts.not_applicable),
            "—" if chapter.counts.samples is None else str(chapter.counts.samples),
            chapter.counts.disturbed or "—",
            chapter.counts.verdicts,
        )
        for chapter in chapters
    ]
    blocks: list[Block] = [Paragraph(text)]
    if all(chapter.status == "completed" and not chapter.counts.failed for chapter in chapters):
        blocks.append(Paragraph("All runs are complete, and nothing failed."))
    if withdrawn := dict.fromkeys(text for chapter in chapters for text in chapter.withdrawn):
        blocks += [Paragraph("Withdrawn of what these files say:"), Bullets(tuple(withdrawn))]
    blocks.append(shown_table(table_of(head, rows, ("Failed", "n/a", "Samples")), "At a glance"))
    blocks.append(
        Paragraph(
            "Verdicts are counted over all comparisons of a file; a cell of two studies counts in both. Of a "
            "stability file the checks are counted: those of variants that are there to compare may fail. "
            "What the words mean is said under Method. Disturbed: samples taken while other processes had the CPU, or "
            "at a low clock; every flag is counted under What was left out, and why."
        )
    )
    return blocks


def _machines(chapters: Sequence[Chapter]) -> list[Block]:
    """A list of facts for each machine; files whose facts differ get separate lists even for equal machine names."""
    groups: dict[tuple, list[Chapter]] = {}
    for chapter in chapters:
        groups.setdefault((chapter.machine, chapter.machine_facts), []).append(chapter)
    blocks: list[Block] = []
    for (machine, facts), members in groups.items():
        blocks.append(Heading(machine))
        files = ("Files", ", ".join(chapter.title for chapter in members))
        blocks.append(Facts((*((name, one_line(text)) for name, text in facts), files)))
    return blocks


def _what_ran(chapters: Sequence[Chapter], passed_over: Sequence[Path]) -> list[Block]:
    head = ("File", "Suite", "Run", "Date", "Commit", "Uncommitted changes", "Command")
    changes = {"true": "YES", "1": "YES", "": "not said"}
    rows = [
        (
            chapter.title,
            chapter.suite or "none",
            chapter.status,
            chapter.date,
            f"`{chapter.git_sha[:10]}`",
            changes.get(chapter.dirty, "no"),
            f"`{one_line(chapter.command)}`",
        )
        for chapter in chapters
    ]
    blocks: list[Block] = [shown_table(table_of(head, rows), "What ran")]
    if passed_over:
        names = _listed([path.name for path in passed_over])
        blocks.append(Paragraph(f"In the folders given, but no result files, so not here: {names}."))
    return blocks


def _left_out(chapters: Sequence[Chapter]) -> list[Block]:
    blocks: list[Block] = [
        Paragraph("Not applicable, failed and not run are three things: each has a table of its own here.")
    ]

    def table(heading: str, head: tuple[str, ...], field: str, none: str, numeric: tuple[str, ...] = ()) -> None:
        rows = [(chapter.title, *map(str, row)) for chapter in chapters for row in getattr(chapter.left_out, field)]
        blocks.append(Heading(heading))
        blocks.append(shown_table(table_of(head, rows, numeric), heading) if rows else Paragraph(none))

    table(
        "Not applicable",
        ("File", "Study or case", "Reason", "How many"),
        "not_applicable",
        "Nothing: every variant that was asked for could run.",
    )
    table("Failed", ("File", "What", "Message"), "failed", "Nothing failed.")
    table(
        "Doubtful, interrupted or flagged",
        ("File", "What", "How many", "Of"),
        "doubts",
        "Nothing.",
        ("How many",),
    )
    table("Figures not drawn", ("File", "Study", "Reason"), "not_drawn", "None: every figure was drawn.")
    return blocks


def _scenes(chapters: Sequence[Chapter], pictures: Sequence[ScenePicture]) -> list[Block]:
    blocks: list[Block] = []
    shown = [(picture.image, picture.caption) for picture in pictures if picture.image is not None]
    if shown:
        blocks.append(Pictures(tuple(shown)))
    lacking = [picture for picture in pictures if picture.image is None]
    if lacking:
        blocks.append(Paragraph(f"{plural(len(lacking), 'scene')} without a picture. {NO_PICTURES}"))
        rows = [(picture.scene, f"`{picture.scene_hash}`", picture.sizes, picture.failure) for picture in lacking]
        table = table_of(("Scene", "Hash", "Measured at", "Why there is no picture"), rows)
        blocks.append(shown_table(table, "Scenes without a picture", fold=True))
    cases = sum(chapter.stability_cases for chapter in chapters)
    if cases:
        blocks.append(
            Paragraph(
                f"The {plural(cases, 'case')} of the stability files build scenes of their own, many at each point; "
                "they are not pictured."
            )
        )
    if not pictures and not cases:
        blocks.append(Paragraph("The files name no scene."))
    return blocks


def _method(chapters: Sequence[Chapter]) -> list[Block]:
    is_timed = any(chapter.counts.samples is not None for chapter in chapters)
    blocks: list[Block] = []
    if is_timed:
        blocks += [
            Heading("Times and verdicts"),
            Paragraph(
                f"Times are medians of render wall time per sample per pixel (spp). Intervals: {INTERVAL_TEXT}. "
                f"{VERDICT_RULE} Low-clock samples are flagged, never dropped."
            ),
            Paragraph(
                "A variant's film was compared with its reference's before it was timed: a cell whose claim did not "
                "hold has no time and is listed as failed."
            ),
        ]
    if any(chapter.has_gpu for chapter in chapters):
        blocks.append(Paragraph(GPU_TEXT))
    if any(chapter.has_convergence for chapter in chapters):
        blocks += [Heading("Convergence"), *(Paragraph(text) for text in (*RULES, EFFICIENCY_RULE))]
    if any(chapter.stability_cases for chapter in chapters):
        blocks += [Heading("Stability"), Paragraph(STABILITY_RULE)]
    blocks.append(
        Paragraph(
            "Where a figure's caption or a note refers to `summary.md`, which `python3 -m ptbench plots` writes: the "
            "table and the notes below that figure hold the same."
        )
    )
    return blocks


def _raw(chapters: Sequence[Chapter]) -> list[Block]:
    blocks: list[Block] = [
        Paragraph(
            "As CSV with a head, one row a sample, checkpoint or check, everything that identifies it in columns; "
            "times in milliseconds. Samples that failed have a message instead of times. Cells that have no sample "
            "are in the tables above only."
        )
    ]
    return [*blocks, *(download for chapter in chapters for download in chapter.downloads)]


def title_of(chapters: Sequence[Chapter]) -> str:
    """The title of the report, which names the machines of its files."""
    machines = list(dict.fromkeys(chapter.machine for chapter in chapters))
    return f"ptbench report: {', '.join(machines)}"
