#!/usr/bin/env python3
"""The cost of each step of a target's build: CPU seconds (user and system) of each command, run one at a time.

The sum over the number of cores bounds the time of a build from a clean clone. CPU seconds are used because other work
on the machine hardly changes them. The commands are Ninja's, in its order, so the build folder is complete afterwards.
With --repeat, each command counts with its fastest of several runs.
"""

import argparse
import json
import os
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

# Kinds of build steps; a step belongs to the first whose pattern matches its output.
GROUPS = [
    ("precompiled headers", r"\.gch$"),
    ("nvcc", r"ptbench_nvcc\.dir/"),
    ("CPU integrators", r"generated/integrator_|cpu_integrators"),
    ("rest of variants/", r"ptbench_variants\.dir/"),
    ("harness/ that renders", r"ptbench_rendering\.dir/"),
    ("rest of harness/", r"ptbench_harness\.dir/|ptbench\.dir/"),
    ("tests", r"tests?/.*\.o$"),
    ("link and generate", r""),
]


def output_of(command: str) -> str:
    found = re.search(r"(?:^|\s)-o (\S+)", command)
    return found.group(1) if found else command.split("&&")[-1].strip()[:60]


def cpu_seconds(command: str, folder: Path) -> float:
    process = subprocess.Popen(["/bin/sh", "-c", command], cwd=folder)
    _, status, used = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"build_seconds: exit status {status}: {command}")
    return used.ru_utime + used.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="a configured build folder (Ninja)")
    parser.add_argument("target", nargs="+", help="what to build, for instance ptbench")
    parser.add_argument("--only", default="", help="only steps whose output matches this regular expression")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--out", type=Path, help="write the seconds of each step here, as JSON")
    arguments = parser.parse_args()
    commands = subprocess.run(
        ["ninja", "-C", str(arguments.folder), "-t", "commands", *arguments.target],
        check=True,
        capture_output=True,
        text=True,
    ).stdout.splitlines()
    steps = {}
    for command in (c for c in commands if c.strip() and re.search(arguments.only, output_of(c))):
        name = output_of(command)
        steps[name] = min(cpu_seconds(command, arguments.folder) for _ in range(arguments.repeat))
        print(f"{steps[name]:8.2f} {name}", flush=True)
    groups = defaultdict(list)
    for name, seconds in steps.items():
        groups[next(group for group, pattern in GROUPS if re.search(pattern, name))].append(seconds)
    print("\n| group | steps | CPU s |\n|---|---|---|")
    for group, _ in GROUPS:
        if groups[group]:
            print(f"| {group} | {len(groups[group])} | {sum(groups[group]):.1f} |")
    print(f"| all | {len(steps)} | {sum(steps.values()):.1f} |")
    if arguments.out:
        arguments.out.write_text(json.dumps(steps, indent=1) + "\n")


if __name__ == "__main__":
    main()
