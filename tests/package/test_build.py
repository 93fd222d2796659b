"""tools/build.py on small CMake projects: what it says, where, and when."""

import importlib.util
import os
import pty
import re
import subprocess
import sys
from pathlib import Path

import pytest

TOOL = Path(__file__).parents[2] / "tools" / "build.py"
STATUS = re.compile(r"ptbench: \[\d+/6\] \d+:\d\d(, about \d+:\d\d left)?")


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("build_tool", TOOL)
    module = importlib.util.module_from_spec(spec)
    sys.modules["build_tool"] = module
    spec.loader.exec_module(module)
    return module


def project(folder: Path, script: str, steps: int = 6) -> Path:
    """A configured build folder whose target `made` has so many steps, each of which runs the script in that folder."""
    (folder / "step.sh").write_text(script + "\n")
    (folder / "CMakeLists.txt").write_text(
        f"""cmake_minimum_required(VERSION 3.22)
project(small LANGUAGES NONE)
foreach(i RANGE 1 {steps})
  add_custom_command(OUTPUT ${{i}}.o COMMAND sh ../step.sh COMMAND ${{CMAKE_COMMAND}} -E touch ${{i}}.o)
  list(APPEND outputs ${{i}}.o)
endforeach()
add_custom_target(made DEPENDS ${{outputs}})
"""
    )
    subprocess.run(["cmake", "-G", "Ninja", "-S", folder, "-B", folder / "build"], check=True, capture_output=True)
    return folder / "build"


def call(build: Path, *arguments: str) -> subprocess.CompletedProcess:
    command = [sys.executable, TOOL, build, "--jobs", "2", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)


def test_a_short_build_in_a_log_is_one_line(tmp_path):
    build = project(tmp_path, "true")
    done = call(build, "made")
    assert (done.returncode, done.stdout, done.stderr) == (0, "ptbench: building with 2 jobs\n", "")
    assert "[6/6]" in (build / "build.log").read_text()
    assert (build / "6.o").exists()


def test_a_terminal_has_one_line_that_is_rewritten(tmp_path):
    build = project(tmp_path, "sleep 0.4")
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [sys.executable, TOOL, build, "--jobs", "2", "made"], stdout=theirs, stdin=subprocess.DEVNULL
    ):
        os.close(theirs)
        said = b""
        while block := read_or_end(ours):
            said += block
    first, *rest = said.decode().replace("\r\n", "\n").split("\n")
    assert first == "ptbench: building with 2 jobs"
    assert len(rest) == 1
    lines = [line.removesuffix("\x1b[K") for line in rest[0].split("\r")[1:]]
    assert lines.pop() == ""
    assert lines
    assert [line for line in lines if not STATUS.fullmatch(line)] == []
    assert any(" left" in line for line in lines)


def test_a_log_has_a_line_now_and_then(tool, tmp_path, monkeypatch, capsys):
    build = project(tmp_path, "sleep 0.3")
    monkeypatch.setattr(tool, "SECONDS_BETWEEN_LINES", 0.2)
    assert tool.build(build, 2, ["made"], build / "build.log") == (0, "")
    lines = capsys.readouterr().out.splitlines()
    assert 1 <= len(lines) <= 6
    assert [line for line in lines if not STATUS.fullmatch(line)] == []


def read_or_end(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # Linux says so where the other side is closed
        return b""


def test_what_fails_is_said_and_fails(tmp_path):
    build = project(tmp_path, "echo told; exit 3", steps=1)
    done = call(build, "made")
    assert done.returncode == 1
    assert "told" in done.stderr.splitlines()
    assert done.stdout == "ptbench: building with 2 jobs\n"


def test_a_precompiled_header_that_was_not_saved_is_built_once_more(tmp_path):
    fails_once = "test -e there || { touch there; echo internal compiler error: in gt_pch_save; exit 1; }"
    build = project(tmp_path, fails_once, steps=1)
    done = call(build, "--called-from", str(tmp_path), "made")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[1] == (
        "ptbench: g++ broke down saving a precompiled header (log: build/build.log.first): building once more"
    )
    assert "gt_pch_save" in (build / "build.log.first").read_text()


def entry(start: int, end: int, output: str) -> str:
    return f"{start}\t{end}\t0\t{output}\tabc\n"


def test_time_left_is_what_steps_of_a_kind_take(tool, tmp_path):
    outputs = ["a/1.o", "a/2.o", "a/3.o", "b/1.o", "b/2.o"]
    left = tool.TimeLeft(tmp_path, outputs)
    assert left.seconds(5, 0, 5) is None
    log = tmp_path / ".ninja_log"
    log.write_text("# ninja log v5\n" + entry(0, 4000, "a/1.o") + entry(0, 1000, "b/1.o"))
    # 5 s of work in 2.5 s; left: two of 4 s and one of 1 s
    assert left.seconds(2.5, 2, 5) == pytest.approx(4.5)


def test_time_left_knows_what_a_step_took_before(tool, tmp_path):
    log = tmp_path / ".ninja_log"
    log.write_text("# ninja log v5\n" + entry(0, 4000, "a/1.o") + entry(0, 10000, "a/2.o"))
    left = tool.TimeLeft(tmp_path, ["a/1.o", "a/2.o"])
    assert left.seconds(1, 0, 2) is None, "nothing of this build is known yet"
    with log.open("a") as file:
        file.write(entry(0, 2000, "a/1.o"))
    assert left.seconds(2, 1, 2) == pytest.approx(10)


def test_clock(tool):
    assert [tool.clock_text(seconds) for seconds in (0, 59.6, 3599, 3601)] == ["0:00", "1:00", "59:59", "1:00:01"]
