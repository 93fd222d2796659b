"""What every kind of file says of the run that wrote it."""


class OfARun:
    """A file with a context."""

    context: dict[str, str]

    def about(self, key: str) -> str:
        """A ptbench context value, or "unknown" where the file does not have it."""
        return self.context.get(f"ptbench.{key}") or "unknown"

    @property
    def git(self) -> str:
        """The program's commit, and whether its sources were changed."""
        dirty = self.context.get("ptbench.git_dirty", "").lower() in ("true", "1")
        return self.about("git_sha") + (" (dirty)" if dirty else "")
