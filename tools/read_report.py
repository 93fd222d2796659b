"""Reads a JUnit report of GoogleTest or pytest.

Prints the numbers of passed, failed and skipped tests and the failed ones' names, one a line; messages to stderr.
"""

import sys
import xml.etree.ElementTree as ElementTree

passed, skipped, failed = 0, 0, []
for case in ElementTree.parse(sys.argv[1]).iter("testcase"):
    problems = case.findall("failure") + case.findall("error")
    if case.get("status") == "notrun":
        continue
    if problems:
        failed.append(f"{case.get('classname')}.{case.get('name')}")
        for problem in problems:
            text = (problem.text or problem.get("message") or "").strip().splitlines()
            print(f"-- {failed[-1]}", *(f"   {line}" for line in text[-40:]), sep="\n", file=sys.stderr)
    elif case.find("skipped") is not None:
        skipped += 1
    else:
        passed += 1
print(passed, len(failed), skipped, *failed, sep="\n")
