"""A package's gpu_tests on made test programs, which answer as Google Test's do."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
VERSION = "ptbench 1.0.0 (commit 0123456789012345678901234567890123456789)"
# A stand-in for a test program, each of whose cases does what its name says. What fills the memory is of a suite that
# says so, and fails if it is not alone.
PROGRAM = """#!/usr/bin/env python3
import json, os, pathlib, signal, sys, time
if "--gtest_list_tests" in sys.argv:
    print("Running main() from gtest_main.cc")
    for suite in ("All.", "MemoryAlone."):
        print(suite)
        for case in CASES:
            if case.startswith("Fills") == (suite == "MemoryAlone."):
                print("  " + case + "  # GetParam() = 1")
    sys.exit(0)
case = next(a for a in sys.argv if a.startswith("--gtest_filter=")).partition(".")[2]
running = pathlib.Path(__file__).parent / "running"
running.mkdir(exist_ok=True)
mark = running / (case.replace("/", ".") + str(os.getpid()))
mark.touch()
crowded = False
for look in range(10 if case.startswith(("Fills", "Lasts")) else 1):
    crowded = crowded or case.startswith("Fills") and len(list(running.iterdir())) > 1
    time.sleep(0.02)
report = next(a for a in sys.argv if a.startswith("--gtest_output=json:")).partition("json:")[2]
if case == "Crashes":
    os.kill(os.getpid(), signal.SIGSEGV)
if case == "Hangs":
    time.sleep(60)
word = "SKIPPED" if case == "IsSkipped" else "COMPLETED"
with open(report, "w") as file:
    json.dump({"testsuites": [{"testsuite": [{"name": case, "result": word}]}]}, file)
print("said by " + case)
mark.unlink()
sys.exit(1 if case == "Fails" or crowded else 0)
"""


class Package:
    """A folder with gpu_tests, a ptbench that tells who it is, and test programs."""

    def __init__(self, folder: Path):
        self.folder = folder
        (folder / "tests").mkdir()
        (folder / "cuda").write_text("available: nvidia-h100")
        shutil.copy(ROOT / "packaging" / "gpu_tests", folder / "gpu_tests")
        self.program(
            "ptbench",
            f"""#!/bin/sh
case $1 in
machine) echo nvidia-h100 ;;
--version) echo "{VERSION}" ;;
list) printf 'Axes\\n\\nBackends\\n  cpu   available\\n  cuda  %s\\n\\nScenes\\n' "$(cat "$(dirname "$0")/cuda")" ;;
esac
""",
        )

    def program(self, name: str, text: str) -> None:
        path = self.folder / name
        path.write_text(text)
        path.chmod(0o755)

    def test(self, name: str, *cases: str) -> None:
        self.program(f"tests/{name}_test", PROGRAM.replace("CASES", repr(list(cases))))

    def run(self, *words: str) -> tuple[int, str, dict | None]:
        done = subprocess.run(
            [sys.executable, self.folder / "gpu_tests", *words], capture_output=True, text=True, check=False
        )
        file = self.folder / "results/nvidia-h100/gpu_tests.json"
        return done.returncode, done.stdout + done.stderr, json.loads(file.read_text()) if file.exists() else None


@pytest.fixture
def package(tmp_path):
    return Package(tmp_path)


def test_all_programs_run_and_their_outcome_is_kept(package):
    package.test("gate", "Holds/0", "Holds/1")
    package.test("segments", "Holds", "IsSkipped")
    code, said, document = package.run()
    assert code == 0, said
    assert "3 passed, 0 failed, 1 skipped" in said
    assert document["context"]["ptbench.git_sha"] == VERSION.partition("commit ")[2].rstrip(")")
    assert document["context"]["ptbench.git_dirty"] == "false"
    counts = {name: (one["passed"], one["failed"], one["skipped"]) for name, one in document["programs"].items()}
    assert counts == {"gate_test": (2, 0, 0), "segments_test": (1, 0, 1)}
    assert list(package.folder.rglob("*.partial")) == []


@pytest.mark.parametrize(("case", "told"), [("Fails", "said by Fails"), ("Crashes", "exit code -11")])
def test_what_fails_or_crashes_is_named_and_the_others_run(package, case, told):
    package.test("gate", "Holds", case)
    code, said, document = package.run()
    assert code == 1
    assert f"FAILED gate_test All.{case}" in said
    assert document["programs"]["gate_test"]["passed"] == 1
    assert document["programs"]["gate_test"]["failures"] == [{"case": f"All.{case}", "said": told}] or (
        told in document["programs"]["gate_test"]["failures"][0]["said"]
    )


def test_what_fills_the_memory_runs_alone_and_last(package):
    package.test("faults", "Fills/0", "Lasts/0", "Lasts/1")
    package.test("gate", "Fills/1", "Lasts/2", "Lasts/3")
    code, said, document = package.run()
    assert code == 0, said
    assert {name: one["passed"] for name, one in document["programs"].items()} == {"faults_test": 3, "gate_test": 3}


def test_what_hangs_is_ended_at_the_limit(package):
    package.test("gate", "Hangs", "Holds")
    code, said, document = package.run("--seconds", "3")
    assert code == 1
    assert "ran out of time" in said
    assert document["programs"]["gate_test"]["failed"] >= 1


def test_a_machine_without_a_gpu_writes_nothing(package):
    package.test("gate", "Holds", "IsSkipped")
    (package.folder / "cuda").write_text("not available (no NVIDIA driver)")
    code, said, document = package.run()
    assert (code, document) == (3, None)
    assert "no GPU to test: cuda not available (no NVIDIA driver)" in said


def test_a_program_that_does_not_start_is_named(package):
    package.program("tests/gate_test", "#!/bin/sh\necho libfoo.so not found >&2\nexit 127\n")
    code, said, document = package.run()
    assert (code, document) == (3, None)
    assert "gate_test does not start: libfoo.so not found" in said


def test_what_it_writes_is_as_its_schema_says(package):
    from ptbench.io.validate import validate

    package.test("gate", "Holds", "Fails")
    package.run()
    assert validate(package.folder / "results/nvidia-h100/gpu_tests.json") == []
