"""The exceptions that end a command, each with its exit code."""

from ptbench.terminal import visible


class InputError(Exception):
    """The input or the call is wrong: one line for the user, exit code 2."""

    def __init__(self, message: str):
        super().__init__(visible(message))


class MachineError(Exception):
    """The machine failed, as a full disk does: one line for the user, exit code 3."""

    def __init__(self, message: str):
        super().__init__(visible(message))


class NotDrawable(Exception):
    """Raised where a study has nothing to draw; the message is the reason. Other studies are still drawn."""


class FindingError(Exception):
    """Raised for a sentence that its results contradict, a missing number, or results older than the page allows."""


def bad_value(file: object, place: str, found: str, allowed: str) -> InputError:
    """The error for a bad input in its one form: file, place, what was found, what is allowed."""
    return InputError(f"{file}: {place}: found {found}, allowed: {allowed}")
