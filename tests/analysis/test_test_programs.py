"""tools/test_programs.py: each test file of a build once, with a filter of its own tests where files share one."""

import json
import os
import subprocess
import sys

import pytest
from conftest import ROOT

LISTED = {
    "testsuites": [
        {"name": "Math/0", "testsuite": [{"name": "Sine", "file": "../tests/unit/math_test.cpp"}]},
        {
            "name": "Film",
            "testsuite": [
                {"name": "Sums", "file": "/src/tests/unit/film_test.cpp"},
                {"name": "Turns", "file": "../tests/unit/math_test.cpp"},
            ],
        },
    ]
}


@pytest.fixture
def build(tmp_path):
    """A folder with unit_tests, which holds two files, and with alone_test, which cannot be asked for its tests."""
    program = tmp_path / "unit_tests"
    program.write_text(
        f"#!{sys.executable}\nimport sys\nreport = sys.argv[2].removeprefix('--gtest_output=json:')\n"
        f"open(report, 'w').write({json.dumps(LISTED)!r})\n"
    )
    os.chmod(program, 0o755)
    (tmp_path / "programs.txt").write_text("math_test unit_tests\nalone_test alone_test\nfilm_test unit_tests\n")
    return tmp_path


def listed(build, excluded=None):
    call = [sys.executable, str(ROOT / "tools/test_programs.py"), str(build), "--flags", str(build)]
    if excluded is not None:
        (build / "excluded.txt").write_text(excluded)
        call += ["--excluded", str(build / "excluded.txt")]
    return subprocess.run(call, capture_output=True, text=True)


def flags(build, name):
    return (build / f"{name}.flags").read_text()


def test_each_file_has_its_program_and_its_tests(build):
    ended = listed(build)
    assert ended.returncode == 0, ended.stderr
    assert sorted(ended.stdout.splitlines()) == [
        "alone_test alone_test",
        "film_test unit_tests",
        "math_test unit_tests",
    ]
    assert flags(build, "math_test") == "--gtest_filter=Math/0.Sine:Film.Turns\n"
    assert flags(build, "film_test") == "--gtest_filter=Film.Sums\n"
    assert flags(build, "alone_test") == "--gtest_filter=*\n"


def test_what_is_excluded_is_left_out(build):
    ended = listed(build, "# minutes\nmath_test Film.*\nmath_test Math/1.*\nalone_test *\n")
    assert ended.returncode == 0, ended.stderr
    assert flags(build, "math_test") == "--gtest_filter=Math/0.Sine:Film.Turns-Film.*:Math/1.*\n"
    assert flags(build, "alone_test") == "--gtest_filter=*-*\n"
    assert "-" not in flags(build, "film_test").removeprefix("--")


@pytest.mark.parametrize(
    ("programs", "excluded", "message"),
    [
        ("math_test unit_tests\nfilm_test unit_tests\n", "mth_test *\n", "there is no test file mth_test"),
        ("math_test unit_tests\nother_test unit_tests\n", "", "found tests of ['film_test', 'math_test']"),
    ],
)
def test_lists_that_do_not_fit_are_refused(build, programs, excluded, message):
    (build / "programs.txt").write_text(programs)
    ended = listed(build, excluded)
    assert ended.returncode != 0
    assert message in ended.stderr
