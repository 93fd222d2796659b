"""A Slurm cluster of four nodes on this machine, from Debian's packages slurm-wlm and munge, without systemd.

Each node is a slurmd of its own name and port. Needs root: slurmd starts jobs as whoever submitted them.
"""

from __future__ import annotations

import os
import secrets
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

NODES = ("n1", "n2", "n3", "n4")
_PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol")
# A requeued task waits until its credential has run out, two minutes as a rule.
_CONFIGURATION = """ClusterName=ptbench
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort={port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
ReturnToService=2
SlurmdTimeout=10
KillWait=3
JobRequeue=1
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
NodeName=n[1-4] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs=1 RealMemory=1000
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing_programs() -> list[str]:
    """What has to be installed before there can be a cluster."""
    return [program for program in _PROGRAMS if shutil.which(program, path=f"{os.environ['PATH']}:/usr/sbin") is None]


def wait_until(condition, seconds: float, what: str) -> None:
    """Waits for it; raises TimeoutError."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"{what}: not within {seconds:.0f} s")
        time.sleep(0.2)


def _parent_of(process: int) -> int:
    return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])


def _program_of(process: int) -> str:
    return os.path.basename(os.readlink(f"/proc/{process}/exe"))


def _is_program(process: int, program: str) -> bool:
    try:
        return _program_of(process) == program
    except OSError:
        return False


def kill(process: int, number: int = signal.SIGKILL) -> None:
    """Sends a signal to a process that may be gone."""
    try:
        os.kill(process, number)
    except ProcessLookupError:
        return


class Cluster:
    """Runs between `with` and its end; its folder keeps the daemons' logs."""

    def __init__(self, folder: Path):
        self.folder = folder
        self._daemons: dict[str, subprocess.Popen] = {}
        self.environment = os.environ | {
            "SLURM_CONF": str(folder / "slurm.conf"),
            "PATH": f"{os.environ['PATH']}:/usr/sbin",
        }

    def __enter__(self) -> Cluster:
        (self.folder / "state").mkdir()
        key = self.folder / "munge.key"
        key.write_bytes(secrets.token_bytes(1024))
        key.chmod(0o600)
        port = _free_ports(1 + len(NODES))
        (self.folder / "slurm.conf").write_text(
            _CONFIGURATION.format(
                host=socket.gethostname().partition(".")[0], folder=self.folder,
                port=port, first=port + 1, last=port + len(NODES),
            )
        )  # fmt: skip
        try:
            own = {name: f"{self.folder}/munge.{name}" for name in ("socket", "pid", "log", "seed")}
            self._start(
                "munged", "--foreground", "--force", f"--key-file={key}", f"--socket={own['socket']}",
                f"--pid-file={own['pid']}", f"--log-file={own['log']}", f"--seed-file={own['seed']}",
            )  # fmt: skip
            wait_until(Path(own["socket"]).exists, 10, "munged")
            self._start("slurmctld", "-D")
            for node in NODES:
                self.start_node(node)
            wait_until(lambda: self.called("sinfo", "-h", "-t", "idle", "-o", "%D") == "4", 30, "four idle nodes")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_) -> None:
        for node in NODES:
            self.kill_node(node)
        for daemon in reversed(self._daemons.values()):
            daemon.terminate()
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def _start(self, name: str, *arguments: str) -> subprocess.Popen:
        with open(self.folder / f"{name}.out", "ab") as out:
            self._daemons[" ".join((name, *arguments[-1:]))] = daemon = subprocess.Popen(
                [name, *arguments], env=self.environment, stdout=out, stderr=out, start_new_session=True
            )
        return daemon

    def start_node(self, node: str) -> None:
        """Starts the slurmd of a node."""
        self._start("slurmd", "-D", "-N", node)

    def kill_node(self, node: str) -> None:
        """Kills slurmd and all that runs under it at once, as a power cut would."""
        daemon = self._daemons.pop(f"slurmd {node}", None)
        if daemon is None:
            return
        os.killpg(daemon.pid, signal.SIGKILL)
        daemon.wait()
        for process in self.processes_on(node):
            kill(process)

    def processes_on(self, node: str, program: str = "") -> list[int]:
        """The processes of jobs on a node, those that start and watch a job first; `program`: only its own."""
        wanted = {f"SLURMD_NODENAME={node}".encode(), f"SLURM_CONF={self.folder}/slurm.conf".encode()}
        jobs, steps = [], []
        for folder in Path("/proc").iterdir():
            try:
                if not folder.name.isdigit() or not wanted <= set((folder / "environ").read_bytes().split(b"\0")):
                    continue
                jobs.append(int(folder.name))
                parent = _parent_of(jobs[-1])
                if _program_of(parent).startswith("slurmstepd") and parent not in steps:
                    steps.append(parent)
            except OSError:
                continue
        return [process for process in steps + jobs if not program or _is_program(process, program)]

    def called(self, *command: str) -> str:
        """What a command of Slurm says."""
        answer = subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False)
        return answer.stdout.strip()

    def is_idle(self) -> bool:
        """Whether no job is queued or runs."""
        return self.called("squeue", "-h") == ""


def _free_ports(count: int) -> int:
    """The first of so many that follow each other and are free."""
    for first in range(26000, 32000, count):
        sockets = [socket.socket() for _ in range(count)]
        try:
            for offset, one in enumerate(sockets):
                one.bind(("127.0.0.1", first + offset))
            return first
        except OSError:
            continue
        finally:
            for one in sockets:
                one.close()
    raise OSError("no free ports")
