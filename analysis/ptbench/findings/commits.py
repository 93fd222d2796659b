"""How many commits have changed the kernels since a result's commit.

results/lost_commits.json names those of results' commits that no history has any more, each with the commit of the
history that their work is part of, which counts in their place, and why they are lost.
"""

import json
import re
from pathlib import Path

from ptbench.git import git

LOST = "lost_commits.json"


def lost_commits(results: Path) -> dict[str, dict[str, str]]:
    """Lost commits by their whole hash: the commit that has the work (`within`), and `why` it is lost."""
    file = results / LOST
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def standing_for(results: Path, commit: str) -> str:
    """The commit of the history that counts for a result's, which may be shortened."""
    for lost, about in lost_commits(results).items():
        if lost.startswith(commit):
            return about["within"]
    return commit


def commit_of(version: str) -> str:
    """What `ptbench --version` says of its commit; empty where it says none."""
    found = re.search(r"commit ([0-9a-f]{40})", version)
    return found[1] if found else ""


def shown_commit(results: Path, commit: str) -> str:
    """Seven digits, and what stands for it where it is lost."""
    within = standing_for(results, commit)
    if within == commit:
        return commit[:7]
    return f"{commit[:7]} ([lost](../../results/{LOST}), part of {within[:7]})"


def has_whole_history(repository: Path) -> bool:
    """Whether this is a git repository in which every commit of the history lies."""
    return git(repository, "rev-parse", "--is-shallow-repository") == "false"


def commits_since(repository: Path, commit: str) -> int | None:
    """Commits to kernels/ and variants/ since `commit`; None where git or the commit is not there."""
    count = git(repository, "rev-list", "--count", f"{commit}..HEAD", "--", "kernels", "variants")
    return None if count is None else int(count)


def age_fault(repository: Path, results: Path, commit: str, allowed: int) -> str:
    """Why a result of this commit is too old, or of no age that can be told; empty where it is not."""
    behind = commits_since(repository, standing_for(results, commit))
    if behind is None:
        if not has_whole_history(repository):
            return ""
        return f"was measured at commit {commit[:7]}, which the history does not have: name it in results/{LOST}"
    if behind > allowed:
        return (
            f"was measured {behind} commits to kernels/ and variants/ ago, the page allows {allowed}: "
            "measure again, or say why it still holds"
        )
    return ""
