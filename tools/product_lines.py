"""Counts the lines of the product by top-level folder in the named commits, to compare them.

    python3 tools/product_lines.py COMMIT..

Lines of code, comments and blank lines count, in everything that is built, run or read by a program: C++, CUDA, Python,
CMake and shell. Tests are shown beside the sum; documents and results are not counted.
"""

import argparse
import subprocess
from collections import Counter

PRODUCT = ("kernels", "variants", "harness", "stability", "analysis/ptbench", "tools", "cmake", "packaging", "run")
TESTS = ("tests",)
ENDINGS = (".h", ".cpp", ".cu", ".cuh", ".py", ".cmake", ".txt", ".in", ".sh")


def lines_of(commit: str) -> Counter:
    """The number of lines in a commit, by top-level folder; a file without an extension counts as a script."""
    call = ["git", "grep", "--count", "", commit, "--", *PRODUCT, *TESTS]
    found = subprocess.run(call, check=True, capture_output=True, text=True).stdout
    lines: Counter = Counter()
    for line in found.splitlines():
        path, number = line.partition(":")[2].rsplit(":", 1)
        name = path.rsplit("/", 1)[-1]
        if name.endswith(ENDINGS) or "." not in name:
            lines[path.split("/")[0]] += int(number)
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("commits", nargs="+", metavar="COMMIT")
    for commit in parser.parse_args().commits:
        lines = lines_of(commit)
        product = sum(number for room, number in lines.items() if room not in TESTS)
        rooms = ", ".join(f"{room} {number}" for room, number in sorted(lines.items()))
        print(f"{commit}: product {product} ({rooms})")


if __name__ == "__main__":
    main()
