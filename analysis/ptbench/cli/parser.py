"""An argparse parser whose error messages are one line, as all of ptbench's, and suggest the nearest known word."""

import argparse
from collections.abc import Iterable
from difflib import get_close_matches

from ptbench.terminal import visible


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line, exit code 2."""

    def error(self, message: str):
        """Ends the process with one line on stderr: SystemExit(2)."""
        self.exit(2, f"{self.prog}: {visible(message)}; see --help\n")

    def parse_known_args(self, args=None, namespace=None):
        """Parses as argparse does, after a check for misspelt options."""
        # Misspelt options are refused before argparse complains of a missing argument, which is only their consequence.
        if args is not None:
            self._refuse_unknown_options(args)
        return super().parse_known_args(args, namespace)

    def _check_value(self, action: argparse.Action, value: object) -> None:
        """Replaces argparse's check that a word is one of a few choices, for ptbench's own error message."""
        if action.choices is None or value in action.choices:
            return
        word = "command" if action.nargs == argparse.PARSER else "word"
        message = f'found the {word} "{value}"{_meant(value, action.choices)}, allowed: {", ".join(action.choices)}'
        raise argparse.ArgumentError(action if word == "word" else None, message)

    def _refuse_unknown_options(self, args: Iterable[str]) -> None:
        known = self._option_string_actions
        for argument in args:
            name = argument.partition("=")[0]
            if argument == "--" or (self._subparsers is not None and not argument.startswith("-")):
                return
            # As argparse does: a lone dash or a word with a space is no option, and an option may be abbreviated.
            if not argument.startswith("-") or argument == "-" or " " in argument or _is_number(argument):
                continue
            if not any(option == name or (name.startswith("--") and option.startswith(name)) for option in known):
                options = sorted(option for option in known if option.startswith("--"))
                self.error(f'found the option "{name}"{_meant(name, options)}, allowed: {", ".join(options)}')


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _meant(word: object, known: Iterable[str]) -> str:
    """A suggestion of the known word nearest to a misspelt one; empty if none is near enough."""
    near = get_close_matches(str(word), list(known), 1)
    return f' (did you mean "{near[0]}"?)' if near else ""
