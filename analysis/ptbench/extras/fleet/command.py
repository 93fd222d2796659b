"""`python3 -m ptbench fleet A.json B.json .. --inspect FILE..`: compares GPUs; exit code 0, or 2 for bad input."""

import argparse

from ptbench.document.markdown import markdown_page
from ptbench.document.text import as_text
from ptbench.errors import NotDrawable
from ptbench.extras.fleet.fleet import fleet_of
from ptbench.extras.fleet.text import sections
from ptbench.io.files import check_output_folder, make_folder, write_text
from ptbench.terminal import say


def fleet_command(options: argparse.Namespace) -> int:
    """Runs `fleet`: compares GPUs, predicts ratios and prints both; raises InputError."""
    if options.out is not None:
        check_output_folder(options.out)
    fleet = fleet_of(options.results, options.inspect, options.gpu)
    print(as_text(sections(fleet, whole=False)), end="")
    if options.out is None:
        return 0
    make_folder(options.out)
    page = markdown_page("A suite on several GPUs", sections(fleet, whole=True))
    print()
    try:
        # matplotlib is imported here because loading it takes a moment.
        from ptbench.extras.fleet.figure import save_predictions

        figures = save_predictions(fleet, options.out)
    except NotDrawable as error:
        figures = []
        say(f"not drawn: {error}")
    pictures = [f"![{path.stem}]({path.name})" for path in figures if path.suffix == ".png"]
    page += "".join(f"\n{picture}\n" for picture in pictures)
    for written in [*figures, write_text(options.out / "fleet.md", page)]:
        say(written)
    return 0
