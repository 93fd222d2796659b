"""Any other JSON file, such as a manual record, as a source for a page."""

from ptbench.errors import FindingError
from ptbench.findings.source import OTHER, Source
from ptbench.numbers import figures


class Record(Source, form=OTHER):
    """Numbers and texts of a JSON file, looked up by their path in it."""

    def __call__(self, place: str) -> str:
        """The number or text at a path such as "prototype.cornell_open.nee_over_off"."""
        value = self._value
        for name in place.split("."):
            if not isinstance(value, dict) or name not in value:
                raise FindingError(f"{self._shown}: nothing at {place}")
            value = value[name]
        return figures(value, 3) if isinstance(value, float) else str(value)

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file and what it is."""
        return f"- {self._link}: a record made by hand, which says what it leaves out."
