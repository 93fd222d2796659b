"""`python3 -m ptbench passport A.json [B.json ..]`: prints the answers; exit code 0, or 2 for bad input."""

from pathlib import Path

from ptbench.document.markdown import markdown_page
from ptbench.document.text import as_text
from ptbench.extras.passport.passport import load_passport
from ptbench.extras.passport.text import sections
from ptbench.io.files import check_output_file, write_text
from ptbench.terminal import say


def passport_command(passports: list[Path], out: Path | None) -> int:
    """Runs `passport`: prints the passports side by side, and writes the page if asked; raises InputError."""
    if out is not None:
        check_output_file(out)
    found = [load_passport(file) for file in passports]
    parts = sections(found)
    print(as_text(parts), end="")
    if out is not None:
        title = "Passport" if len(found) == 1 else "Passports"
        say(write_text(out, markdown_page(f"{title}: {', '.join(one.name for one in found)}", parts)))
    return 0
