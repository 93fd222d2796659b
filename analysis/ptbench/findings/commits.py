"""Counts the commits that changed the kernels since a result's commit.

results/lost_commits.json lists commits of results that are in no history any more, each with the commit that contains
their work and counts in their place, and the reason.
"""

import json
import re
from pathlib import Path

from ptbench.git import git

LOST = "lost_commits.json"


def lost_commits(results: Path) -> dict[str, dict[str, str]]:
    """Lost commits by full hash: the commit that contains the work (`within`), and `why` it is lost."""
    file = results / LOST
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def standing_for(results: Path, commit: str) -> str:
    """The commit in the history that stands for a result's commit, which may be abbreviated."""
    for lost, about in lost_commits(results).items():
        if lost.startswith(commit):
            return about["within"]
    return commit


def commit_of(version: str) -> str:
    """The commit in the output of `ptbench --version`; empty where there is none."""
    found = re.search(r"commit ([0-9a-f]{40})", version)
    return found[1] if found else ""


def shown_commit(results: Path, commit: str) -> str:
    """The abbreviated commit, with the one that stands for it if it is lost."""
    within = standing_for(results, commit)
    if within == commit:
        return commit[:7]
    return f"{commit[:7]} ([lost](../../results/{LOST}), part of {within[:7]})"


def has_whole_history(repository: Path) -> bool:
    """Whether `repository` is a git repository with its full history."""
    return git(repository, "rev-parse", "--is-shallow-repository") == "false"


def commits_since(repository: Path, commit: str) -> int | None:
    """The number of commits to kernels/ and variants/ since `commit`; None where git or the commit is missing."""
    count = git(repository, "rev-list", "--count", f"{commit}..HEAD", "--", "kernels", "variants")
    return None if count is None else int(count)


def age_fault(repository: Path, results: Path, commit: str, allowed: int) -> str:
    """Why a result of a commit is too old, or of unknown age; empty where it is recent enough."""
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
