"""A check for ReFrame (https://reframe-hpc.readthedocs.io): that a suite of ptbench runs and its films are correct.

    PTBENCH=build/ptbench reframe -C SITE.py -c tools/reframe/ptbench_check.py -r

The exit code of `ptbench run` tells whether a cell failed or a film differed. Each cell's median rate goes to ReFrame's
performance log, and may be compared with a system's reference values.
"""

import json
import os
import re
from pathlib import Path

import reframe as rfm
import reframe.utility.sanity as sn
from reframe.core.builtins import deferrable, parameter, run_before, sanity_function, variable


@rfm.simple_test
class PtbenchSuite(rfm.RunOnlyRegressionTest):
    """A ReFrame test that runs one suite on one backend; `--setvar suite=cis565` selects the suite."""

    descr = "ptbench: films verified, then timed"
    backend = parameter(["cpu", "cuda"])
    suite = variable(str, value="quick")
    valid_systems = ["*"]  # noqa: RUF012 (ReFrame's own variables)
    valid_prog_environs = ["*"]  # noqa: RUF012

    @run_before("run")
    def set_call(self):
        """Sets the ptbench command line; the cuda backend needs a GPU in the system's ReFrame configuration."""
        self.executable = str(Path(os.environ.get("PTBENCH", "build/ptbench")).resolve())
        self.executable_opts = ["run", "--suite", self.suite, "--backend", self.backend, "--out", "result.json"]
        self.keep_files = ["result.json"]
        if self.backend == "cuda":
            self.extra_resources = {"gpu": {"num_gpus_per_node": "1"}}

    @sanity_function
    def no_cell_failed(self):
        """Checks that no cell failed, by the last line and the exit code."""
        return sn.all(
            [sn.assert_eq(self.job.exitcode, 0), sn.assert_found(r"\d+ cells, \d+ samples, 0 failed", self.stdout)]
        )

    @deferrable
    def rate(self, cell):
        """The median rate of a cell's samples, in rays per second."""
        rows = json.loads((Path(self.stagedir) / "result.json").read_text())["benchmarks"]
        rates = sorted(row["pt_rays_per_second"] for row in rows if row["run_name"] == cell and "pt_order" in row)
        return rates[len(rates) // 2]

    @run_before("performance")
    def set_rates(self):
        """Sets one performance variable per cell."""
        cells = json.loads((Path(self.stagedir) / "result.json").read_text())["ptbench"]["cells"]
        names = [cell["cell"] for cell in cells if cell["status"] == "ok"]
        self.perf_variables = {
            re.sub(r"[^A-Za-z0-9]+", "_", name): sn.make_performance_function(self.rate(name), "rays/s")
            for name in names
        }
