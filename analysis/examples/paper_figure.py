"""A figure for a paper from a committed result: what each compaction costs over none, in an open and a closed box.

Run it in the repository's root, `.venv/bin/python analysis/examples/paper_figure.py`; it writes paper_figure.pdf there.
"""

import matplotlib.pyplot as plt

import ptbench

rows = ptbench.load("results/nvidia-h200/compaction.json").frame("verdicts")
rows = rows[(rows["study"] == "wavefront") & (rows["layout"] == "soa") & rows["ratio"].notna()]
figure, axes = plt.subplots(figsize=(5, 3.2), layout="constrained")
for (scene, of_scene), marker in zip(rows.groupby("scene", observed=True), "os", strict=True):
    bars = [of_scene["ratio"] - of_scene["ratio_low"], of_scene["ratio_high"] - of_scene["ratio"]]
    axes.errorbar(of_scene["ratio"], of_scene["compaction"].astype(str), xerr=bars, fmt=marker, label=scene, ms=4)
axes.axvline(1, color="black", linewidth=0.8)
axes.set(xscale="log", xlabel="Time over no compaction (95 % interval)")
figure.legend(loc="outside upper center", ncols=2)
figure.savefig("paper_figure.pdf")
