"""Which files are read and written: regular ones of a limited size, and names are shown as what they are."""

from __future__ import annotations

import errno
import gzip
import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from builder import Builder, small
from conftest import PACKAGE

from ptbench import __version__
from ptbench.cli.main import main
from ptbench.errors import InputError, MachineError
from ptbench.io.files import LARGEST_RESULT, move_whole, read_stored, read_whole, write_text, write_whole
from ptbench.io.images import read_pfm
from ptbench.io.nodes import read_json
from ptbench.terminal import visible

NO_REGULAR_FILE = "no regular file (a device, a pipe or a socket)"


def one_cell(path: Path) -> Path:
    builder = Builder().study("compaction")
    builder.cell("compaction")
    builder.cell("compaction", axes={"compaction": "scan"}, ms_per_spp=2.0)
    return builder.write(path)


def test_what_a_call_reads_it_does_not_write(tmp_path, analysis):
    results = [one_cell(tmp_path / name) for name in ("a.json", "b.json")]
    (tmp_path / "link.json").symlink_to("b.json")
    before = [result.read_bytes() for result in results]
    for out in ("a.json", "b.json", "link.json"):
        code, _, err = analysis("compare", *results, "--json", tmp_path / out)
        assert code == 2
        assert err == (
            f"python3 -m ptbench: {tmp_path / out}: output file: found a file that this call reads, "
            "allowed: another file\n"
        )
        assert [result.read_bytes() for result in results] == before


def test_a_report_replaces_reports_alone(tmp_path, analysis):
    result, out = one_cell(tmp_path / "a.json"), tmp_path / "out"
    out.mkdir()
    (out / "report.html").write_text("mine", encoding="utf-8")
    code, _, err = analysis("report", result, "--out", out)
    assert code == 2
    assert err.endswith(
        f"{out / 'report.html'}: output file: found a file that is there, and no report of ptbench, "
        "allowed: a folder of its own, or one with an earlier report\n"
    )
    assert [(path.name, path.read_text(encoding="utf-8")) for path in out.iterdir()] == [("report.html", "mine")]
    (out / "report.html").unlink()
    for _ in range(2):
        assert analysis("report", result, "--out", out)[0] == 0
    (out / "report.md").write_text("mine", encoding="utf-8")
    assert analysis("report", result, "--out", out)[0] == 2
    assert (out / "report.md").read_text(encoding="utf-8") == "mine"


def odd_files(folder: Path) -> dict[str, Path]:
    """Things that are no regular file, by what the error says of each."""
    kinds = {
        f"{NO_REGULAR_FILE} #pipe": folder / "pipe.json",
        f"{NO_REGULAR_FILE} #socket": folder / "socket.json",
        f"{NO_REGULAR_FILE} #device": Path("/dev/full"),
        f"{NO_REGULAR_FILE} #link": folder / "zeros.json",
        "a folder": folder / "folder.json",
        "a link to nothing": folder / "broken.json",
        "a link that leads to itself": folder / "loop.json",
        "a path through a file that is no folder": folder / "file.txt" / "a.json",
    }
    os.mkfifo(folder / "pipe.json")
    # A socket's name has at most 107 bytes: by a short one, then renamed.
    short = Path(f"/tmp/ptbench-{os.getpid()}-{time.monotonic_ns()}")
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(short))
        os.rename(short, folder / "socket.json")
    (folder / "zeros.json").symlink_to("/dev/zero")
    (folder / "folder.json").mkdir()
    (folder / "broken.json").symlink_to(folder / "nowhere")
    (folder / "loop.json").symlink_to(folder / "loop.json")
    (folder / "file.txt").write_text("x", encoding="utf-8")
    return kinds


class Hung(BaseException):
    """A call that took longer than any may; no OSError, which the command would explain."""


@pytest.fixture
def called(capsysbinary) -> Callable[..., subprocess.CompletedProcess]:
    """The command in this process, with a time limit: what hangs shall fail. Bytes out, for any name."""

    def late(*_: object) -> None:
        raise Hung

    def call(*arguments: object) -> subprocess.CompletedProcess:
        before = signal.signal(signal.SIGALRM, late)
        signal.alarm(120)
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as leaving:
            code = leaving.code
        finally:
            signal.alarm(0)
            signal.signal(signal.SIGALRM, before)
        said = capsysbinary.readouterr()
        return subprocess.CompletedProcess(arguments, code, said.out, said.err)

    return call


def called_apart(*arguments: object, cwd: Path | None = None, **environment: str) -> subprocess.CompletedProcess:
    """The same in a process of its own."""
    command = [sys.executable, "-m", "ptbench", *map(os.fsencode, map(str, arguments))]
    whole = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), **environment}
    return subprocess.run(command, capture_output=True, check=False, timeout=120, env=whole, cwd=cwd)


def test_what_cannot_be_read_is_told_apart(tmp_path):
    kinds = odd_files(tmp_path) | {"no such file": tmp_path / "nothing.json"}
    done = called_apart("validate", *kinds.values())
    assert (done.returncode, done.stdout) == (2, b"")
    lines = done.stderr.decode().splitlines()
    assert len(lines) == len(kinds)
    for line, (kind, path) in zip(lines, kinds.items(), strict=True):
        found = kind.partition(" #")[0]
        allowed = "a regular file of at most 1024 MiB that can be read"
        assert line == f"python3 -m ptbench: {path}: the file: found {found}, allowed: {allowed}"


@pytest.mark.parametrize(
    "arguments",
    [
        ("plots", "PIPE"),
        ("report", "PIPE", "--out", "OUT"),
        ("report", "GOOD", "PIPE", "--out", "OUT"),
        ("report", "GOOD", "MISSING", "--out", "OUT"),
        ("report", "LOOP", "--out", "OUT"),
        ("compare", "GOOD", "PIPE"),
        ("compare", "GOOD", "GOOD", "--noise", "PIPE"),
        ("explain", "PIPE", "none", "scan"),
        ("explain", "GOOD", "none", "scan", "--counters", "PIPE"),
        ("gallery", "--binary", "GOOD", "--spec", "PIPE", "--out", "OUT"),
        ("validate", "PIPE"),
        ("validate", "JOURNAL"),
    ],
    ids=" ".join,
)
def test_every_command_refuses_what_is_no_file(tmp_path, called, arguments):
    os.mkfifo(tmp_path / "pipe.json")
    os.mkfifo(tmp_path / "result.json.journal.jsonl")
    (tmp_path / "loop.json").symlink_to(tmp_path / "loop.json")
    places = {"PIPE": "pipe.json", "JOURNAL": "result.json.journal.jsonl", "LOOP": "loop.json", "OUT": "out"}
    places |= {"GOOD": "good.json", "MISSING": "missing.json"}
    one_cell(tmp_path / "good.json")
    done = called(*(tmp_path / places[word] if word in places else word for word in arguments))
    assert (done.returncode, done.stdout) == (2, b"")
    said = done.stderr.decode()
    assert said.count("\n") == 1
    assert ": the file: found " in said
    assert not (tmp_path / "out").exists()


def test_a_file_without_permission_says_so(tmp_path, monkeypatch):
    """Tests may run as root, whom no file refuses, so the system's refusal is put in by hand."""
    path = one_cell(tmp_path / "a.json")

    def refuse(*_, **__):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(InputError, match=r"a\.json: the file: found no permission, allowed: a regular file"):
        read_json(path)


def test_sizes_have_limits(tmp_path, analysis):
    path = tmp_path / "large.json"
    path.touch()
    os.truncate(path, LARGEST_RESULT + 1)  # a file with a hole, which takes no room
    code, out, err = analysis("validate", path)
    assert (code, out) == (2, "")
    assert f"{path}: the file: found {LARGEST_RESULT + 1} bytes, too large, allowed: a regular file of at most" in err
    os.truncate(path, 5)
    assert read_whole(path, 5) == bytes(5)
    with pytest.raises(InputError, match="found 5 bytes, too large"):
        read_whole(path, 4)


def test_links_to_regular_files_are_read(tmp_path):
    (tmp_path / "link.json").symlink_to(one_cell(tmp_path / "a.json"))
    assert read_json(tmp_path / "link.json").value == read_json(tmp_path / "a.json").value


def test_images_are_regular_files(tmp_path):
    os.mkfifo(tmp_path / "a.pfm")
    with pytest.raises(InputError, match="found no regular file"):
        read_pfm(tmp_path / "a.pfm")
    with pytest.raises(InputError, match="found a name that no file can have"):
        read_pfm(tmp_path / "a\0.pfm")


def test_only_regular_files_are_replaced(tmp_path):
    for kind, path in odd_files(tmp_path).items():
        mode = os.lstat(path).st_mode if "through" not in kind else None
        with pytest.raises(InputError, match=r"output file: found .*, allowed: a file, new or regular") as refused:
            write_text(path, "text")
        assert kind.partition(" #")[0] in str(refused.value)
        if mode is not None:
            assert os.lstat(path).st_mode == mode
    source = tmp_path / "done.png"
    source.write_text("picture", encoding="utf-8")
    with pytest.raises(InputError, match="output file: found no regular file"):
        move_whole(source, tmp_path / "pipe.json")
    assert not list(tmp_path.glob(".*"))


def test_a_link_stays_and_its_file_is_replaced(tmp_path):
    target = tmp_path / "elsewhere" / "report.md"
    target.parent.mkdir()
    target.write_text("old", encoding="utf-8")
    link = tmp_path / "report.md"
    link.symlink_to(target)
    assert write_text(link, "new") == link
    assert link.is_symlink()
    assert target.read_text(encoding="utf-8") == "new"
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["elsewhere", "report.md", "report.md"]


def test_a_disk_that_is_full_is_one_line(tmp_path):
    def write(path: Path) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(MachineError, match=r"a\.md: cannot be written: No space left on device$"):
        write_whole(tmp_path / "a.md", write)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", ["plots", "report"])
def test_a_disk_that_is_full_is_exit_code_3(tmp_path, analysis, monkeypatch, command):
    """Whichever of its files finds no room: the first is a figure, or a page."""
    file = small().write(tmp_path / "quick.json")

    def write(path: Path, data: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", write)
    code, _, err = analysis(command, file, "--out", tmp_path / "out")
    assert code == 3
    assert err.endswith(": cannot be written: No space left on device\n")
    assert err.count("\n") == 1
    assert not [path for path in (tmp_path / "out").rglob("*") if path.is_file()]


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (("plots", "GOOD", "--out", "OUT"), "summary.md"),
        (("plots", "GOOD", "--out", "OUT"), "compaction.png"),
        (("report", "GOOD", "--out", "OUT"), "report.md"),
        (("report", "GOOD", "--out", "OUT"), "report.html"),
        (("compare", "GOOD", "OTHER", "--out", "OUT"), "compare.md"),
        (("compare", "GOOD", "OTHER", "--json", "OUT/c.json"), "c.json"),
        (("explain", "GOOD", "none", "scan", "--out", "OUT"), "explain.md"),
    ],
    ids=lambda value: value if isinstance(value, str) else value[0],
)
@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
def test_every_command_leaves_what_is_no_file(tmp_path, analysis, arguments, name, kind):
    out = tmp_path / "out"
    out.mkdir()
    if kind == "pipe":
        os.mkfifo(out / name)
    elif kind == "device":
        (out / name).symlink_to("/dev/full")
    else:
        (out / name).mkdir()
    one_cell(tmp_path / "good.json")
    other = json.loads((tmp_path / "good.json").read_text(encoding="utf-8"))
    for row in other["benchmarks"]:
        if "pt_timestamp" in row:
            row["pt_timestamp"] += 1e5
    (tmp_path / "other.json").write_text(json.dumps(other), encoding="utf-8")
    places = {"GOOD": tmp_path / "good.json", "OTHER": tmp_path / "other.json", "OUT": out, "OUT/c.json": out / name}
    code, _, err = analysis(*(places.get(word, word) for word in arguments))
    assert code == 2
    assert err.count("\n") == 1
    found = "a folder" if kind == "folder" else NO_REGULAR_FILE
    assert f"{out / name}: output file: found {found}, allowed: a file, new or regular" in err
    status = os.lstat(out / name)
    assert not os.path.isfile(out / name), status


@pytest.mark.parametrize(
    "arguments",
    [
        ("plots", "GOOD", "--out", "TAKEN"),
        ("report", "GOOD", "--out", "TAKEN"),
        ("compare", "GOOD", "GOOD", "--out", "TAKEN"),
        ("explain", "GOOD", "none", "scan", "--out", "TAKEN"),
        ("gallery", "--binary", "/bin/true", "--out", "TAKEN"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_file_where_a_folder_is_needed(tmp_path, analysis, arguments):
    good = one_cell(tmp_path / "good.json")
    for taken, found in ((good, "a file, which is no folder"), (Path("/dev/null"), "a file, which is no folder")):
        places = {"GOOD": good, "TAKEN": taken}
        code, out, err = analysis(*(places.get(word, word) for word in arguments))
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert f"{taken}: output folder: found {found}, allowed: a folder that can be made" in err


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("plain ×", "plain ×"),
        ("\x1b[31mred", r"\x1b[31mred"),
        ("two\nlines\r\t", r"two\x0alines\x0d\x09"),
        ("\udcff", r"\xff"),
        ("\ud800", r"\ud800"),
        ("\x9b2J\x7f", r"\x9b2J\x7f"),
        ("\u202etxt.exe", r"\u202etxt.exe"),
    ],
)
def test_what_a_terminal_would_obey_is_shown(text, shown):
    assert visible(text) == shown
    assert visible(shown) == shown
    assert str(InputError(text)) == shown


NASTY = b"a\x1b[2J\xff\n.json"
SHOWN = r"a\x1b[2J\xff\x0a.json"


def clean(data: bytes) -> str:
    """What was said, which has nothing but printable characters and ends of lines in it."""
    text = data.decode("utf-8")
    assert all(character.isprintable() or character == "\n" for character in text), data
    return text


def test_names_are_shown_escaped_by_every_command(tmp_path, called):
    nasty = Path(os.fsdecode(bytes(tmp_path) + b"/" + NASTY))
    one_cell(nasty)
    again = one_cell(tmp_path / "again.json")
    document = json.loads(again.read_text(encoding="utf-8"))
    for row in document["benchmarks"]:
        if "pt_timestamp" in row:
            row["pt_timestamp"] += 1e5
    again.write_text(json.dumps(document), encoding="utf-8")
    out = Path(os.fsdecode(bytes(tmp_path) + b"/out\x1b\xff"))
    for arguments in (
        ("plots", nasty, "--out", out),
        ("plots", nasty),
        ("report", nasty, "--out", out),
        ("compare", nasty, again, "--out", out, "--json", out / "c.json"),
        ("explain", nasty, "none", "scan", "--out", out),
        ("validate", nasty),
    ):
        done = called(*arguments)
        said = clean(done.stdout) + clean(done.stderr)
        assert done.returncode == (1 if arguments[0] == "validate" else 0), said
        assert "--out" not in arguments or r"out\x1b\xff" in said
        assert arguments[0] != "validate" or SHOWN in said
    wrong = called_apart("validate", nasty.with_name(nasty.name + "2"), PYTHONUTF8="1")
    assert SHOWN + "2: the file: found no such file" in clean(wrong.stderr)
    assert wrong.stderr.count(b"\n") == 1


def test_values_of_files_are_shown_escaped(tmp_path, called):
    builder = Builder().study("an\x1b[31m\x9b\nodd one", figure="none")
    builder.cell("an\x1b[31m\x9b\nodd one", "sc\x1bene")
    path = builder.write(tmp_path / "a.json")
    done = called("plots", path, "--out", tmp_path / "out")
    assert done.returncode == 0
    assert r"not drawn: an\x1b[31m\x9b\x0aodd one: " in clean(done.stdout)
    clean(done.stderr)


@pytest.mark.parametrize(
    "arguments",
    [
        ("pl\x1bots",),
        ("plots", "a", "--o\x1but", "x"),
        ("plots", "a", "x\x1b\udcff"),
        ("compare", "a", "b", "--fail-on", "slow\x1b\udcff\n"),
        ("gallery", "--binary", "a", "--out", "b", "--spp", "\x1b1"),
    ],
    ids=["command", "option", "argument", "word", "number"],
)
def test_words_of_the_call_are_shown_escaped(called, arguments):
    done = called(*arguments)
    assert done.returncode == 2
    assert r"\x1b" in clean(done.stderr)
    assert done.stderr.count(b"\n") == 1


def test_an_output_that_is_not_utf_8_gets_escapes(tmp_path):
    done = called_apart("validate", tmp_path / "√.json", PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert done.returncode == 2
    assert rb"\u221a.json: the file: found no such file" in done.stderr


def test_half_a_character_in_a_string_is_refused(tmp_path, analysis):
    path = tmp_path / "half.json"
    text = small().write(path).read_text(encoding="utf-8")
    path.write_text(text.replace('"cornell_open"', '"corn\\ud83d"', 1), encoding="utf-8")
    code, out, err = analysis("plots", path)
    assert (code, out) == (2, "")
    assert err.endswith(f"{path}: a string: found half of a character (\\ud83d), allowed: whole characters\n")
    path.write_text(json.dumps(["\U0001f600", "\\ud83d"]), encoding="utf-8")  # two halves; a backslash and letters
    assert read_json(path).value == ["\U0001f600", "\\ud83d"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("plot", "x.json"), 'found the command "plot" (did you mean "plots"?), allowed: plots, '),
        (("validte", "x.json"), 'found the command "validte" (did you mean "validate"?), allowed: '),
        (
            ("compare", "a", "b", "--fail-on", "slowr"),
            'found the word "slowr" (did you mean "slower"?), allowed: slower',
        ),
        (("compare", "a", "b", "--fail-on=slowr"), 'found the word "slowr" (did you mean "slower"?)'),
        (("compare", "a", "b", "--fial-on", "slower"), 'found the option "--fial-on" (did you mean "--fail-on"?)'),
        (("report", "a", "--uot", "b"), 'report: found the option "--uot" (did you mean "--out"?), allowed: --binary'),
        (("plots", "a", "--oot=b"), 'found the option "--oot" (did you mean "--out"?), allowed: --help, --out'),
        (("--versoin",), 'found the option "--versoin" (did you mean "--version"?)'),
        (("pie",), 'found the command "pie", allowed: plots, '),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_the_nearest_word_is_named(analysis, arguments, said):
    code, out, err = analysis(*arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert said in err


def test_options_may_still_be_begun_and_follow_a_dash_dash(analysis, tmp_path):
    good = one_cell(tmp_path / "good.json")
    assert analysis("plots", good, "--ou", tmp_path / "out")[0] == 0
    code, _, err = analysis("validate", "--", "--nothing")
    assert code == 2
    assert "--nothing: the file: found no such file" in err


def test_the_version_is_told(analysis):
    assert analysis("--version") == (0, f"ptbench-analysis {__version__}\n", "")


def test_a_compressed_file_is_read_for_its_name(tmp_path):
    """Under either name; the plain one comes first where both are there."""
    packed = tmp_path / "a.json.gz"
    packed.write_bytes(gzip.compress(b'{"a": 1}', mtime=0))
    for name in ("a.json", "a.json.gz"):
        assert read_stored(tmp_path / name) == (tmp_path / "a.json", b'{"a": 1}')
        assert read_json(tmp_path / name).need("a").integer() == 1
    (tmp_path / "a.json").write_bytes(b'{"a": 2}')
    assert read_json(tmp_path / "a.json").need("a").integer() == 2
    assert read_json(packed).need("a").integer() == 1


@pytest.mark.parametrize("cut", [5, 15, -1])
def test_a_compressed_file_that_is_cut_short_is_refused(tmp_path, cut):
    packed = tmp_path / "a.json.gz"
    packed.write_bytes(gzip.compress(b'{"a": 1}' * 100, mtime=0)[:cut])
    with pytest.raises(InputError, match=r"a\.json\.gz.*no whole gzip file"):
        read_json(tmp_path / "a.json")


def test_a_compressed_file_has_a_limit_when_unpacked(tmp_path):
    (tmp_path / "a.json.gz").write_bytes(gzip.compress(b" " * 5000, mtime=0))
    with pytest.raises(InputError, match="more bytes when unpacked"):
        read_stored(tmp_path / "a.json", 4000)
