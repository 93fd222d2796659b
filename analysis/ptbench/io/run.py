"""The context of a run, which every kind of result file contains."""


class OfARun:
    """Base class of files that contain the context of a run."""

    context: dict[str, str]

    def about(self, key: str) -> str:
        """A ptbench context value, or "unknown" where the file lacks it."""
        return self.context.get(f"ptbench.{key}") or "unknown"

    @property
    def git(self) -> str:
        """The commit of the program that ran, and whether its sources were modified."""
        dirty = self.context.get("ptbench.git_dirty", "").lower() in ("true", "1")
        return self.about("git_sha") + (" (dirty)" if dirty else "")
