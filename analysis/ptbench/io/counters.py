"""Hardware counters of a kernel by ncu, as files of `ptbench inspect` and `ptbench rays` contain them."""

from dataclasses import dataclass

from ptbench.io.nodes import Node

# Names of hardware counters, per ray or as fractions; files up to commit ede9627 spell "_per_" as "_a_".
MEASURED = (
    "achieved_occupancy",
    "active_lanes",
    "warp_instructions_per_ray",
    "thread_instructions_per_ray",
    "memory_bytes_per_ray",
)


@dataclass(frozen=True)
class Counters:
    """The hardware counters of one kernel; those added after commit 14df631 are None in older files."""

    achieved_occupancy: float
    active_lanes: float
    warp_instructions_per_ray: float
    thread_instructions_per_ray: float
    memory_bytes_per_ray: float
    of_ceiling: dict[str, float]
    bound: str  # name of the throughput ceiling of which the kernel reaches the largest fraction
    l1_hit_rate: float | None = None
    l2_hit_rate: float | None = None
    memory_stalls: float | None = None


def counters_of(node: Node) -> Counters:
    """Reads the counters of a kernel from a JSON object; raises InputError."""
    of_ceiling = node.optional_numbers("of_ceiling")
    return Counters(
        **{name: node.need(name).number() for name in MEASURED},
        of_ceiling=of_ceiling,
        bound=node.need("bound").one_of(tuple(of_ceiling)),
        **{name: node.optional_number(name) for name in ("l1_hit_rate", "l2_hit_rate", "memory_stalls")},
    )
