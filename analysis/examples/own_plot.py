"""A figure of one's own from a result file: do the samples drift while a run goes on?

Run it in the repository's root, `.venv/bin/python analysis/examples/own_plot.py`, or cell by cell in an editor that
knows `# %%`, with the package installed (`pip install ".[frames]"`). It writes own_plot.png into the current folder.
"""

# %% A table of samples: one row per timed render, with a column for every axis and setting
from itertools import cycle

import matplotlib

matplotlib.use("Agg")  # delete this line to see figures in a notebook: Agg only writes image files
import matplotlib.pyplot as plt

import ptbench

RESULT = "results/nvidia-h200/seeds.json"
result = ptbench.load(RESULT)
samples = result.frame("samples")
good = samples[samples["status"] == "ok"]
print(f"{len(samples)} samples of {samples['cell'].nunique()} cells, {len(samples) - len(good)} of them failed")

# %% Medians of cells; observed=True omits combinations that were not run, dropna=False keeps rows with missing keys
keys = ["scene", "variant", "width", "depth", "spp"]
medians = good.groupby(keys, observed=True, dropna=False)["ms_per_spp"].median()
print(medians.head(12).to_string())

# %% Each sample over the median of its cell, in the order in which the run took them
drift = good.assign(
    over_median=good["ms_per_spp"] / good.groupby("cell", observed=True)["ms_per_spp"].transform("median"),
    minutes=(good["timestamp"] - good["timestamp"].min()) / 60,
)
figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
for (scene, of_scene), marker in zip(drift.groupby("scene", observed=True), cycle("osD^v"), strict=False):
    axes.plot(of_scene["minutes"], of_scene["over_median"], marker, markersize=3, alpha=0.5, label=scene)
axes.axhline(1, color="black", linewidth=0.8)
axes.set(xlabel="Minutes since the first sample", ylabel="Time over the cell's median")
axes.set_title(f"{samples['machine'].iloc[0]}, commit {samples['commit'].iloc[0][:7]}, {len(good)} samples")
figure.legend(loc="outside right upper")
figure.savefig("own_plot.png", dpi=150)

# %% Where the time goes: each stage's share of the instrumented pass's time, one row per cell and stage
stages = result.frame("stages")
stages["share"] = stages["stage_ms"] / stages["instrumented_wall_ms"]
of_one = stages[(stages["scene"] == "cornell_open") & (stages["layout"] == "aos") & (stages["depth"] == 8)]
shares = of_one.pivot_table(index="variant", columns="stage", values="share", aggfunc="first", observed=True)
print(shares.round(3).to_string())
