"""`check` of a package on machines that are stood up for it: a folder with stubs for what it calls and looks at."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ("sh", "env", "sed", "grep", "head", "tr", "dirname", "readlink", "cat")
V3_FLAGS = "fpu sse sse2 ssse3 sse4_1 sse4_2 avx avx2 bmi1 bmi2 f16c fma abm movbe xsave"


class Machine:
    """A machine that has everything, until something is taken away; and a package on it."""

    def __init__(self, folder: Path):
        self.root = folder / "machine"
        self.package = folder / "package"
        self.commands = folder / "bin"
        self.environment = {"PATH": str(self.commands), "HOME": str(self.root / "home")}
        for made in (self.root / "home", self.package, self.commands):
            made.mkdir(parents=True)
        for tool in TOOLS:
            (self.commands / tool).symlink_to(shutil.which(tool))
        self.pack("2.34", "90-real;75-virtual")
        self.file("proc/cpuinfo", f"processor\t: 0\nflags\t\t: {V3_FLAGS}\nflags\t\t: fpu\n")
        self.file("proc/driver/nvidia/version", "NVRM version")
        self.toolkit("usr/local/cuda", "12.8")
        self.command("uname", "echo x86_64")
        self.glibc("ldd (Debian GLIBC 2.36-9+deb12u9) 2.36")
        self.command("ldconfig", "echo '1 libs found in cache'")
        self.gpu("9.0")
        self.command("python3", '[ "$1" != --version ] || echo Python 3.11.2')
        self.cuda("available: nvidia-h200")

    def pack(self, glibc: str, architectures: str) -> None:
        text = (ROOT / "packaging" / "check").read_text()
        text = text.replace("@GLIBC@", glibc).replace("@ARCHITECTURES@", architectures)
        assert "@" not in re.sub(r'"\$@"|\$@', "", text), "a value that `./run package` does not fill in"
        self._program(self.package / "check", text)

    def file(self, name: str, text: str) -> Path:
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def toolkit(self, name: str, version: str) -> Path:
        major, minor = version.split(".")
        library = self.file(f"{name}/lib64/libnvrtc.so.{version}.93", "")
        (library.parent / f"libnvrtc.so.{major}").symlink_to(library.name)
        self.file(f"{name}/include/cuda/std/cmath", "")
        self.file(f"{name}/include/cuda.h", f"#define CUDA_VERSION {int(major) * 1000 + int(minor) * 10}\n")
        return self.root / name

    def command(self, name: str, script: str) -> None:
        self._program(self.commands / name, f"#!/bin/sh\n{script}\n")

    def glibc(self, first_line: str) -> None:
        self.command("ldd", f"echo '{first_line}'; echo 'Copyright (C)'")

    def gpu(self, capability: str) -> None:
        self.command("nvidia-smi", f"echo {capability}")

    def cuda(self, status: str) -> None:
        """What ptbench says of its CUDA backend."""
        said = (
            f"Suites\n  cuda         a suite of that name\nBackends\n  cpu          available\n  cuda         {status}"
        )
        script = f"#!/bin/sh\n[ -z \"${{PTBENCH_HOME+set}}\" ] || exit 2\ncat <<'TEXT'\n{said}\nTEXT\n"
        self._program(self.package / "ptbench", script)

    def without(self, name: str) -> None:
        path = self.root / name
        shutil.rmtree(path) if path.is_dir() else path.unlink()

    @staticmethod
    def _program(path: Path, text: str) -> None:
        path.write_text(text)
        path.chmod(0o755)

    def check(self) -> tuple[int, dict[str, tuple[str, str]], str]:
        """(exit code, {what: (good|missing|note, the rest of its line)}, the last line)"""
        environment = {**self.environment, "PTBENCH_CHECK_ROOT": str(self.root)}
        done = subprocess.run(
            [self.package / "check"], capture_output=True, text=True, check=False, env=environment, cwd="/"
        )
        assert done.stderr == ""
        *lines, last = done.stdout.splitlines()
        found = {}
        for line in lines:
            match = re.fullmatch(r"(good|missing|note) +(\w+) +(\S.*)", line)
            assert match, line
            assert match[2] not in found, f"two lines on {match[2]}"
            found[match[2]] = (match[1], match[3])
        return done.returncode, found, last

    def missing(self) -> dict[str, str]:
        """What check says is missing; the exit code must go with it."""
        code, found, last = self.check()
        missing = {what: text for what, (word, text) in found.items() if word == "missing"}
        assert code == (3 if missing else 0)
        assert last == "ptbench runs on the GPU and on the CPU" if not missing else "GPU" not in last
        return missing


@pytest.fixture
def machine(tmp_path):
    return Machine(tmp_path)


CPU_ONLY = "ptbench runs on the CPU only"
NOTHING = "ptbench does not run here"


def test_a_machine_that_has_everything(machine):
    code, found, last = machine.check()
    assert code == 0
    assert {word for word, _ in found.values()} == {"good"}
    assert list(found) == ["cpu", "glibc", "driver", "gpu", "nvrtc", "headers", "cache", "figures"]
    assert found["driver"][1] == "nvidia-h200"
    assert found["nvrtc"][1].startswith("12.8 ")
    assert last == "ptbench runs on the GPU and on the CPU"


def test_calls_ptbench_without_the_callers_home(machine):
    machine.environment["PTBENCH_HOME"] = "/nowhere"
    assert machine.missing() == {}


def test_runs_from_anywhere_through_a_link(machine, tmp_path):
    link = tmp_path / "elsewhere"
    link.symlink_to(machine.package / "check")
    environment = {**machine.environment, "PTBENCH_CHECK_ROOT": str(machine.root)}
    assert subprocess.run([link], env=environment, capture_output=True, check=False).returncode == 0


# --- what every backend needs


@pytest.mark.parametrize("flag", ["avx2", "fma", "bmi2", "movbe", "abm"])
def test_a_cpu_without_avx2_and_its_like(machine, flag):
    machine.file("proc/cpuinfo", f"flags\t\t: {V3_FLAGS.replace(f' {flag} ', ' ')}\n")
    machine.cuda("")  # must not be asked: it would end with SIGILL
    code, found, last = machine.check()
    assert (code, last) == (3, NOTHING)
    assert found["cpu"] == ("missing", f"x86-64-v3 (AVX2) is needed, this CPU lacks: {flag}")
    assert found["driver"][0] == "note"


def test_another_architecture(machine):
    machine.command("uname", "echo aarch64")
    code, found, last = machine.check()
    assert (code, last) == (3, NOTHING)
    assert found["cpu"] == ("missing", "this ptbench is for x86-64, this machine is aarch64")


@pytest.mark.parametrize(
    ("said", "here"),
    [
        ("ldd (Ubuntu GLIBC 2.31-0ubuntu9.9) 2.31", "2.31"),
        ("ldd (GNU libc) 2.9", "2.9"),
        ("musl libc (x86_64)", 'none (ldd --version says "musl libc (x86_64)")'),
        ("", 'none (ldd --version says "")'),
    ],
)
def test_an_older_glibc(machine, said, here):
    machine.glibc(said)
    code, found, last = machine.check()
    assert (code, last) == (3, NOTHING)
    assert found["glibc"] == ("missing", f"2.34 or newer is needed, here is {here}")


@pytest.mark.parametrize(
    "said", ["ldd (GNU libc) 2.34", "ldd (Ubuntu GLIBC 2.39-0ubuntu8.3) 2.39", "ldd (GNU libc) 3.0"]
)
def test_a_glibc_that_is_new_enough(machine, said):
    machine.glibc(said)
    assert machine.missing() == {}


def test_a_ptbench_that_does_not_start(machine):
    machine.command("broken", "echo 'ptbench: libgomp.so.1: cannot open shared object file' >&2; exit 127")
    shutil.copy(machine.commands / "broken", machine.package / "ptbench")
    code, found, last = machine.check()
    assert (code, last) == (3, NOTHING)
    assert found["ptbench"][1] == "does not start: ptbench: libgomp.so.1: cannot open shared object file"


# --- what the CUDA backend needs


@pytest.mark.parametrize(
    "reason",
    [
        "no NVIDIA driver",
        "no CUDA device",
        "the driver is for CUDA 12.4, this ptbench needs one for CUDA 13.0",
    ],
)
def test_the_driver(machine, reason):
    machine.cuda(f"not available ({reason})")
    assert machine.missing() == {"driver": reason}
    assert machine.check()[2] == CPU_ONLY


def test_no_driver_and_no_ptbench_to_ask(machine):
    machine.glibc("ldd (GNU libc) 2.17")
    machine.without("proc/driver/nvidia/version")
    assert machine.missing()["driver"] == "no NVIDIA driver"


def test_a_package_without_the_cuda_backend(machine):
    machine.cuda("not available (this ptbench was built without a CUDA toolkit)")
    assert machine.missing() == {"cuda": "this ptbench was built without a CUDA toolkit"}


@pytest.mark.parametrize("capability", ["7.5", "8.0", "8.9", "9.0", "10.0", "12.0"])
def test_a_gpu_that_is_served(machine, capability):
    machine.gpu(capability)
    assert machine.missing() == {}


@pytest.mark.parametrize(
    ("architectures", "capability", "is_served"),
    [
        ("90-real", "9.0", True),
        ("90-real", "8.9", False),
        ("90-real", "10.0", False),
        ("86-real", "8.9", True),
        ("89-real", "8.6", False),
        ("90-real;75-virtual", "7.0", False),
        ("90", "10.0", True),  # CMake: both
        ("120-real", "12.1", True),
    ],
)
def test_gpus_by_what_thrust_is_compiled_for(machine, architectures, capability, is_served):
    machine.pack("2.34", architectures)
    machine.gpu(capability)
    said = f"compute capability {capability}; Thrust and CUB are compiled for {architectures}"
    assert machine.missing() == ({} if is_served else {"gpu": said})


def test_without_nvidia_smi_the_gpu_is_not_judged(machine):
    machine.command("nvidia-smi", "echo 'NVIDIA-SMI has failed'; exit 9")
    assert machine.missing() == {}
    assert "gpu" not in machine.check()[1]


def test_no_toolkit(machine):
    machine.without("usr/local/cuda")
    machine.cuda("not available (libnvrtc (CUDA 12.8 or newer) is not found; set CUDA_HOME)")
    missing = machine.missing()
    assert list(missing) == ["nvrtc", "headers"]
    assert missing["nvrtc"].startswith("no libnvrtc of CUDA 12.8 or newer")
    assert missing["headers"].startswith("no CUDA headers (include/cuda/std)")
    assert machine.check()[1]["driver"] == ("good", "there")


def test_every_line_at_once(machine):
    machine.without("usr/local/cuda")
    machine.cuda("not available (no NVIDIA driver)")
    assert list(machine.missing()) == ["driver", "nvrtc", "headers"]


def test_an_older_toolkit(machine):
    machine.without("usr/local/cuda")
    toolkit = machine.toolkit("usr/local/cuda", "12.6")
    library = toolkit / "lib64" / "libnvrtc.so.12"
    assert machine.missing() == {
        "nvrtc": f"CUDA 12.8 or newer is needed, {library} is of 12.6",
        "headers": f"CUDA 12.8 or newer is needed, those of {toolkit} are of 12.6",
    }


@pytest.mark.parametrize("variable", ["CUDA_HOME", "CUDA_PATH"])
def test_a_toolkit_elsewhere(machine, variable):
    machine.without("usr/local/cuda")
    machine.environment[variable] = str(machine.toolkit("opt/cuda-13", "13.0"))
    code, found, _ = machine.check()
    assert code == 0
    assert found["nvrtc"][1] == f"13.0 {machine.root}/opt/cuda-13/lib64/libnvrtc.so.13"
    assert found["headers"][1] == f"13.0 {machine.root}/opt/cuda-13/include"


def test_the_wheels_of_nvidia_are_a_toolkit(machine):
    """They have libraries in lib, where a toolkit has lib64."""
    machine.without("usr/local/cuda")
    wheels = machine.toolkit("venv/nvidia/cu13", "13.5")
    (wheels / "lib64").rename(wheels / "lib")
    assert list(machine.missing()) == ["nvrtc", "headers"]
    machine.environment["CUDA_HOME"] = str(wheels)
    code, found, _ = machine.check()
    assert code == 0
    assert found["nvrtc"] == ("good", f"13.5 {wheels}/lib/libnvrtc.so.13")


def test_an_nvrtc_that_the_loader_knows(machine):
    machine.without("usr/local/cuda/lib64")
    library = machine.toolkit("opt/libraries", "12.9") / "lib64"
    machine.command("ldconfig", f"printf '\\tlibnvrtc.so.12 (libc6,x86-64) => {library}/libnvrtc.so.12\\n'")
    assert machine.check()[1]["nvrtc"] == ("good", f"12.9 {library}/libnvrtc.so.12")
    machine.command("ldconfig", "exit 1")
    assert list(machine.missing()) == ["nvrtc"]
    machine.environment["LD_LIBRARY_PATH"] = f"/nowhere:{library}"
    assert machine.missing() == {}


@pytest.mark.parametrize(("version", "is_new_enough"), [("13.0", True), ("12.6", False)])
def test_an_nvrtc_whose_file_has_no_minor_number(machine, version, is_new_enough):
    machine.without("usr/local/cuda")
    library = machine.toolkit("usr/local/cuda", version) / "lib64" / f"libnvrtc.so.{version.split('.')[0]}"
    library.unlink()
    library.write_text("")
    (library.parent / f"libnvrtc.so.{version}.93").unlink()
    (library.parent / f"libnvrtc-builtins.so.{version}").write_text("")
    _, found, _ = machine.check()
    said = f"{version} {library}" if is_new_enough else f"CUDA 12.8 or newer is needed, {library} is of {version}"
    assert found["nvrtc"] == ("good" if is_new_enough else "missing", said)


def test_headers_in_a_folder_of_their_own(machine):
    include = machine.root / "usr/local/cuda/include"
    (include / "cccl").mkdir()
    (include / "cuda").rename(include / "cccl" / "cuda")
    assert machine.missing() == {}
    shutil.rmtree(include / "cccl")
    assert list(machine.missing()) == ["headers"]


def test_what_ptbench_alone_knows_is_passed_on(machine):
    machine.cuda("not available (libnvrtc lacks nvrtcGetCUBIN)")
    assert machine.missing() == {"cuda": "libnvrtc lacks nvrtcGetCUBIN"}


def test_a_cache_that_cannot_be_written(machine):
    machine.environment["XDG_CACHE_HOME"] = str(machine.file("home/file", "no folder"))
    assert machine.missing() == {"cache": f"{machine.root}/home/file/ptbench cannot be written: set XDG_CACHE_HOME"}


def test_the_cache_is_looked_at_and_not_made(machine):
    before = sorted(os.walk(machine.root))
    assert machine.check()[1]["cache"] == ("good", f"{machine.root}/home/.cache/ptbench")
    assert sorted(os.walk(machine.root)) == before


# --- what figures need


def test_figures_are_no_condition(machine):
    machine.command("python3", "exit 1")
    code, found, _ = machine.check()
    assert code == 0
    assert found["figures"] == ("note", "need Python 3.10 or newer; result files can be drawn on another machine")


def test_figures_without_their_libraries(machine):
    machine.command("python3", "case $2 in *matplotlib*) exit 1 ;; esac")
    code, found, _ = machine.check()
    assert code == 0
    assert found["figures"][1].endswith(f"pip install -r {machine.package}/analysis/requirements.txt")


# --- ./run package, as far as it goes without building


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--bogus"], "'package' takes --out DIR, got '--bogus'"),
        (["somewhere"], "'package' takes --out DIR, got 'somewhere'"),
        (["--out"], "--out needs a folder"),
        (["--out="], "--out needs a folder"),
    ],
)
def test_bad_calls_of_run_package(arguments, said):
    done = subprocess.run(
        [ROOT / "run", "package", *arguments], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL
    )
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"ptbench: {said}\n")


def test_run_package_removes_nothing_of_yours(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    for out, said in (
        ("out", "out holds notes.txt, which is no part of a package: move it, or name another folder with --out"),
        ("out/notes.txt", "out/notes.txt is no folder: name another with --out"),
    ):
        done = subprocess.run(
            [ROOT / "run", "package", "--out", out],
            capture_output=True,
            text=True,
            check=False,
            cwd=tmp_path,
            stdin=subprocess.DEVNULL,
        )
        assert (done.returncode, done.stdout, done.stderr) == (2, "", f"ptbench: {said}\n")
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"


def numbers_in(pattern: str, file: str) -> set[str]:
    match = re.search(pattern, (ROOT / file).read_text())
    assert match, f"{file} has no {pattern}"
    return set(re.findall(r"\d+", match[1]))


def test_the_tests_build_compiles_for_the_gpus_of_a_package():
    package = numbers_in(r"PTBENCH_PACKAGE_ARCHITECTURES:-([^}]*)\}", "packaging/package.sh")
    own = numbers_in(r'set\(PTBENCH_CUDA_ARCHITECTURES "([^"]*)"', "cmake/cuda.cmake")
    elsewhere = numbers_in(r"set\(oldest_and_newest ([^)]*)\)", "cmake/cuda.cmake")
    supported = numbers_in(r"set\(PTBENCH_SUPPORTED_ARCHITECTURES ([^)]*)\)", "cmake/cuda.cmake")
    assert package <= own | elsewhere
    assert elsewhere == {min(supported, key=int), max(supported, key=int)}


@pytest.mark.skipif(not (shutil.which("clang++") and shutil.which("nvcc")), reason="clang++ or nvcc is not here")
def test_another_compiler_beside_nvcc_is_refused_at_once(tmp_path):
    environment = {**os.environ, "CXX": "clang++", "PTBENCH_BUILD_DIR": str(tmp_path / "build")}
    done = subprocess.run(
        [ROOT / "run", "build"], capture_output=True, text=True, check=False, env=environment, stdin=subprocess.DEVNULL
    )
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "CXX is clang++; beside nvcc, allowed: g++" in done.stderr
