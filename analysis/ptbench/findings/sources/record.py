"""Any other JSON file, such as a record made by hand, as a page asks it."""

from ptbench.errors import FindingError
from ptbench.findings.source import OTHER, Source
from ptbench.numbers import figures


class Record(Source, form=OTHER):
    """Numbers and texts by their place in the file."""

    def __call__(self, place: str) -> str:
        """The number or text at "prototype.cornell_open.nee_over_off"."""
        value = self._value
        for name in place.split("."):
            if not isinstance(value, dict) or name not in value:
                raise FindingError(f"{self._shown}: nothing at {place}")
            value = value[name]
        return figures(value, 3) if isinstance(value, float) else str(value)

    @property
    def provenance(self) -> str:
        """A line of a list: the file and what it is."""
        return f"- {self._link}: a record made by hand, which says what it leaves out."
