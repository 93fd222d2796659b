"""The commands `submit` and `collect`."""

import argparse
import json
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.io.files import write_text
from ptbench.numbers import plural
from ptbench.submit import slurm
from ptbench.submit.collect import Group, groups_of, merge, read_shard, samples_in_journal, tally_of
from ptbench.submit.script import script_of
from ptbench.submit.submission import ANY, Array, Submission, cells_of_shards, read_submission


def _asked(options: argparse.Namespace) -> Submission:
    if options.gpu and options.backend == "cpu":
        raise bad_value("--gpu", "argument", f'"{options.gpu[0]}"', "none with --backend cpu")
    if len(set(options.gpu)) != len(options.gpu):
        raise bad_value("--gpu", "argument", "one model twice", "each once")
    suite = str(Path(options.suite).resolve()) if options.suite.endswith(".json") else options.suite
    binary = str(options.binary.resolve())
    call = ["run", "--suite", suite, "--backend", options.backend, *options.run]
    cells = cells_of_shards(binary, call, options.shards)
    arrays = [Array(model) for model in options.gpu] or [Array(ANY)]
    return Submission(options.out.resolve(), binary, call, options.shards, cells, arrays)


def _known(asked: Submission) -> Submission:
    """The submission in the folder if it equals the one asked for, or the latter if the folder has none."""
    if not (asked.folder / "submission.json").exists():
        return asked
    known = read_submission(asked.folder)
    for key, value in known.settings().items():
        if value != asked.settings()[key]:
            raise bad_value(asked.folder, key, "another submission", "the same one again, or another --out")
    return known


def submit_command(options: argparse.Namespace) -> int:
    """Runs `ptbench submit`: writes the sbatch files and queues shards that are neither done nor queued."""
    submission = _known(_asked(options))
    for array in submission.arrays:
        (submission.folder / array.name).mkdir(parents=True, exist_ok=True)
        script = submission.script(array)
        if not script.exists():
            write_text(script, script_of(submission, array, Path(options.suite).stem, options.time, options.sbatch))
    submission.write()
    for array in submission.arrays:
        if options.dry_run:
            print(f"written: {submission.script(array)}")
            continue
        queued = slurm.tasks_of(array.jobs) if array.jobs else {}
        wanted = [
            shard for shard in range(1, submission.shards + 1)
            if shard not in queued and read_shard(submission.result(array, shard)) is None
        ]  # fmt: skip
        if wanted:
            array.jobs.append(slurm.submit(submission.script(array), wanted))
            submission.write()
            print(f"job {array.jobs[-1]}: shards {_list(wanted)} of {submission.shards} of {array.name}")
        else:
            print(f"{array.name}: nothing to submit: {plural(len(queued), 'shard')} queued, the others are done")
    return 0


def _list(numbers: list[int]) -> str:
    return ", ".join(map(str, numbers))


def _say_missing(submission: Submission, array: Array, group: Group | None, queued: dict[int, str]) -> None:
    for shard in group.missing(submission.shards) if group else range(1, submission.shards + 1):
        cells = submission.cells[str(shard)]
        state = queued.get(shard, "not queued").lower()
        kept = samples_in_journal(submission.result(array, shard))
        told = plural(kept, "sample")
        print(f"  missing: shard {shard} ({plural(len(cells), 'cell')}, first {cells[0]}): {state}, {told} kept")


def _states(array: Array) -> dict[int, str]:
    try:
        return slurm.tasks_of(array.jobs) if array.jobs else {}
    except InputError:  # results may be collected on a machine without Slurm's commands
        return {}


def collect_command(folder: Path) -> int:
    """Runs `ptbench collect`: merges shards by machine; exit code 1 where an array is not complete."""
    submission = read_submission(folder)
    submission.folder = folder.resolve()
    tally: dict = {"schema": "ptbench-tally-1", "shards": submission.shards, "arrays": {}}
    written: set[Path] = set()
    for array in submission.arrays:
        groups = groups_of(submission, array)
        entry = tally["arrays"].setdefault(array.name, {"complete": False, "machines": []})
        for group in groups:
            label = f"{array.name} on {group.machine}"
            facts: dict = {"machine": group.machine, "shards": sorted(group.shards), "left_out": len(group.twice)}
            entry["machines"].append(facts)
            for file in group.twice:
                print(f"{label}: {file.name} left out: its shard is there already, with the same films")
            if group.missing(submission.shards):
                print(f"{label}: {len(group.shards)} of {plural(submission.shards, 'shard')}")
                _say_missing(submission, array, group, _states(array))
                continue
            out = submission.folder / f"{group.machine}.json"
            if out in written:  # another build or GPU model of the machine has written its result
                out = out.with_name(f"{group.machine}.{next(iter(group.shards.values())).identity[:8]}.json")
            merge(submission, group, out)
            written.add(out)
            facts |= tally_of(submission, out)
            is_whole = facts["once"] == facts["cells"] and not facts["missing"] and not facts["twice"]
            entry["complete"] = entry["complete"] or is_whole
            print(f"{label}: complete, {facts['once']} of {facts['cells']} cells once, {facts['failed']} failed: {out}")
        if not groups:
            print(f"{array.name}: 0 of {plural(submission.shards, 'shard')}")
            _say_missing(submission, array, None, _states(array))
        elif not entry["complete"] and len(groups) > 1:
            print("  machines differ, whose times no result may mix: pin one with --gpu, or --sbatch=--constraint=..")
    write_text(submission.folder / "tally.json", json.dumps(tally, indent=1) + "\n")
    return 0 if all(entry["complete"] for entry in tally["arrays"].values()) else 1
