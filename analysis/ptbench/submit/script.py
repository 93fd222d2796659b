"""The sbatch script of a job array, which users may edit for their cluster."""

import shlex
from string import Template

from ptbench.submit.submission import ANY, Array, Submission

# Exit codes after which the script requeues its task: 130 interrupted by time limit or preemption; 3 the machine
# failed, another task still writes the journal, or a rank died; from 128 on killed. A wrong call (2) would fail again.
_SCRIPT = Template("""#!/bin/bash
# $title. Written by `python3 -m ptbench submit`, which leaves it as it is from then on.
# Each task runs one shard. It keeps what it measured in a journal beside its result: ended by its time limit or with
# its node, it goes on wherever Slurm starts it again, and takes no sample twice.
$options
set -u
shard=$$SLURM_ARRAY_TASK_ID
task=$${SLURM_ARRAY_JOB_ID}_$$SLURM_ARRAY_TASK_ID
echo "task $$task, start $$((1 + $${SLURM_RESTART_COUNT:-0})), on $$SLURMD_NODENAME"

$call$part \\
    --out $folder/"shard-$$shard-of-$shards.json" --resume --other-host --quiet &
program=$$!
# Slurm sends USR1 before the time is up: ptbench ends its sample and leaves the rest to the next start. TERM alone
# comes from scancel.
is_late=0 is_cancelled=0
trap 'is_late=1; kill -TERM "$$program"' USR1
trap 'is_cancelled=1; kill -TERM "$$program"' TERM
wait "$$program"
code=$$?
while kill -0 "$$program" 2>/dev/null; do
    wait "$$program"
    code=$$?
done
echo "shard $$shard of $shards: exit code $$code"
is_cut_short=$$((code == 3 || code >= 128)) is_wanted=$$((is_late || !is_cancelled))
if ((is_cut_short && is_wanted && $${SLURM_RESTART_COUNT:-0} < $most_starts - 1)); then
    trap - TERM
    scontrol requeue "$$task"
    sleep 60 # until Slurm takes the task away
fi
exit "$$code"
""")
_MOST_STARTS = 20
_SECONDS_TO_END = 30


def script_of(submission: Submission, array: Array, suite: str, time: str, extra: list[str]) -> str:
    """The full text of an sbatch script."""
    is_cpu = "cpu" in submission.call
    folder = (submission.folder / array.name).resolve()
    resource = "--exclusive" if is_cpu else f"--gres=gpu:{'' if array.name == ANY else array.name + ':'}1"
    options = [
        f"--job-name=ptbench-{suite}",
        f"--array=1-{submission.shards}",
        "--nodes=1",
        "--ntasks=1",
        resource,
        f"--time={time}",
        "--requeue",
        f"--signal=B:USR1@{_SECONDS_TO_END}",
        "--open-mode=append",
        f"--output={folder}/shard-%a.log",
        *extra,
    ]
    return _SCRIPT.substitute(
        title=f"The suite {suite} in {submission.shards} shards, {'one CPU node' if is_cpu else 'one GPU'} a task",
        options="\n".join(f"#SBATCH {option}" for option in options),
        call=" ".join(shlex.quote(word) for word in [submission.binary, *submission.call]),
        part="" if submission.shards == 1 else f' --shard "$shard/{submission.shards}"',
        folder=shlex.quote(str(folder)),
        shards=submission.shards,
        most_starts=_MOST_STARTS,
    )
