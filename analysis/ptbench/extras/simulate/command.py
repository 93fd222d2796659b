"""`python3 -m ptbench simulate`: simulates renders on many GPUs; exit code 0, or 2 for bad input."""

import argparse
from pathlib import Path

from ptbench.document.markdown import markdown_page
from ptbench.document.text import as_text
from ptbench.errors import InputError
from ptbench.extras.simulate.figure import draw
from ptbench.extras.simulate.parts import parts_of
from ptbench.extras.simulate.study import study_of
from ptbench.extras.simulate.text import sections
from ptbench.extras.simulate.work import measure_work
from ptbench.figures import style
from ptbench.figures.saving import save_figure
from ptbench.io.files import check_output_folder, make_folder, write_text
from ptbench.program import Program
from ptbench.terminal import say

FIGURE = "efficiency"


def simulate_command(options: argparse.Namespace) -> int:
    """Runs the simulation, or measures a scene's map of rays per path; raises InputError."""
    if options.out is not None:
        check_output_folder(options.out)
    if options.work is not None:
        return _work(options)
    study = study_of(parts_of(options.results, options.definition))
    found = sections(study)
    print(as_text(found), end="")
    if options.out is not None:
        make_folder(options.out)
        with style.applied():
            written = save_figure(draw(study), options.out, FIGURE)
        page = markdown_page("One render on many GPUs, simulated", found) + f"\n![Efficiency]({FIGURE}.png)\n"
        print()
        for path in [*written, write_text(options.out / "simulation.md", page)]:
            say(path)
    return 0


def _work(options: argparse.Namespace) -> int:
    if options.out is None:
        raise InputError("simulate --work: found no --out, allowed: the folder of the map")
    if options.spp < 1:
        raise InputError(f"--spp: found {options.spp}, allowed: an integer of at least 1")
    Program(options.binary).check()
    make_folder(options.out)
    out = options.out / f"work_{Path(options.work).stem}.json"
    measure_work(options.binary, options.work, options.spp, out)
    say(out)
    return 0
