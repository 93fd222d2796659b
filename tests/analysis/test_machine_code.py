"""tools/machine_code.py: two builds are held against each other program by program and object by object."""

from __future__ import annotations

import importlib.util
import json
import struct
import subprocess
import sys

from conftest import ROOT

PROGRAM = ROOT / "tools/machine_code.py"


def called(*words: object) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)


def written(path, programs: list[str], **objects: str):
    document = {"scenes": {"box": programs, "ball": ["same"]}, "objects": objects}
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def cubin(**sections: bytes) -> bytes:
    """An ELF file with these sections after an empty one, and with their names in the last."""
    names = b"\0" + b"".join(f".{name}\0".replace("_", ".").encode() for name in sections) + b".shstrtab\0"
    parts = [(b"", b""), *((f".{name}".replace("_", ".").encode(), text) for name, text in sections.items())]
    parts.append((b".shstrtab", names))
    body, headers = b"", b""
    for name, text in parts:
        at = names.index(name + b"\0") if name else 0
        headers += struct.pack("<IIQQQQ16x", at, 1, 0, 0, 64 + len(body), len(text))
        body += text
    start = struct.pack("<40xQ10x3H", 64 + len(body), 56, len(parts), len(parts) - 1)
    return start.ljust(64, b"\0") + body + headers


def test_only_instructions_and_the_names_of_kernels_count():
    spec = importlib.util.spec_from_file_location("machine_code", PROGRAM)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    base = tool.hash_of_code(cubin(text_shade=b"abc", symtab=b"1"))
    assert tool.hash_of_code(cubin(symtab=b"22", text_shade=b"abc")) == base
    assert tool.hash_of_code(cubin(text_shade=b"abd", symtab=b"1")) != base
    assert tool.hash_of_code(cubin(text_trace=b"abc", symtab=b"1")) != base


def test_names_each_scene_and_object_whose_code_changed(tmp_path):
    before = written(tmp_path / "before.json", ["1", "1", "2"], cub="3", clock="4", gone="5")
    after = written(tmp_path / "after.json", ["1", "2", "6"], cub="7", clock="4", new="8")
    done = called("--compare", before, after)
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        "box: of 3 programs 1 are gone, of 3 1 are new",
        "cub: another machine code",
        "gone: another machine code",
        "new: another machine code",
    ]
    done = called("--compare", after, after)
    assert (done.returncode, done.stdout) == (0, "the same machine code\n")
