"""Lists the test files of a build, each with its program and the flags by which the program runs that file alone.

    python3 tools/test_programs.py build/tests --flags FOLDER [--excluded FILE]

Prints a line a test file: `NAME PROGRAM`. FOLDER/NAME.flags gets what GoogleTest reads by --gtest_flagfile: a filter
of the tests that stand in that file, less those that FILE leaves out.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path


def tests_by_file(program: Path) -> dict[str, list[str]]:
    """The full names of a program's tests, by the stem of the source file that each stands in."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder, "tests.json")
        call = [str(program), "--gtest_list_tests", f"--gtest_output=json:{report}"]
        subprocess.run(call, check=True, stdout=subprocess.DEVNULL)
        listed = json.loads(report.read_text(encoding="utf-8"))
    found = defaultdict(list)
    for suite in listed["testsuites"]:
        for test in suite["testsuite"]:
            found[Path(test["file"]).stem].append(f"{suite['name']}.{test['name']}")
    return found


def excluded_tests(file: Path | None) -> dict[str, list[str]]:
    """GoogleTest filters by test file: a file of lines `NAME FILTER`, others begin with #."""
    found = defaultdict(list)
    for line in file.read_text(encoding="utf-8").splitlines() if file else []:
        if line and not line.startswith("#"):
            name, pattern = line.split()
            found[name].append(pattern)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="build/tests, with programs.txt")
    parser.add_argument("--flags", type=Path, required=True, metavar="FOLDER", help="where NAME.flags are written")
    parser.add_argument("--excluded", type=Path, metavar="FILE", help="such as tests/sanitize_excluded.txt")
    arguments = parser.parse_args()
    names = defaultdict(list)
    for line in (arguments.folder / "programs.txt").read_text(encoding="utf-8").splitlines():
        name, program = line.split()
        names[program].append(name)
    excluded = excluded_tests(arguments.excluded)
    known = {name for those in names.values() for name in those}
    if unknown := sorted(set(excluded) - known):
        sys.exit(f"test_programs.py: {arguments.excluded}: there is no test file {unknown[0]}")
    for program, those in sorted(names.items()):
        tests = {} if those == [program] else tests_by_file(arguments.folder / program)
        if tests and set(tests) != set(those):
            sys.exit(f"test_programs.py: {program}: found tests of {sorted(tests)}, programs.txt has {sorted(those)}")
        for name in those:
            flags = "--gtest_filter=" + ":".join(tests.get(name, ["*"]))
            if excluded[name]:
                flags += "-" + ":".join(excluded[name])
            (arguments.flags / f"{name}.flags").write_text(flags + "\n", encoding="utf-8")
            print(name, program)


if __name__ == "__main__":
    main()
