"""Runs git commands in a repository."""

import subprocess
from pathlib import Path


def git(repository: Path, *arguments: str) -> str | None:
    """The output of a git command, stripped; None where git fails or is not installed."""
    try:
        answer = subprocess.run(["git", "-C", str(repository), *arguments], capture_output=True, text=True, check=False)
    except OSError:
        return None
    return answer.stdout.strip() if answer.returncode == 0 else None
