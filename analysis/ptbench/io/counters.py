"""What ncu counted of a kernel, as files of `ptbench inspect` and of `ptbench rays` have it."""

from dataclasses import dataclass

from ptbench.io.nodes import Node

# A ray's, or shares; files of commit ede9627 and before have X_a_Y for X_per_Y.
MEASURED = (
    "achieved_occupancy",
    "active_lanes",
    "warp_instructions_per_ray",
    "thread_instructions_per_ray",
    "memory_bytes_per_ray",
)


@dataclass(frozen=True)
class Counters:
    """The counters of one kernel; what came after commit 14df631 is None in older files."""

    achieved_occupancy: float
    active_lanes: float
    warp_instructions_per_ray: float
    thread_instructions_per_ray: float
    memory_bytes_per_ray: float
    of_ceiling: dict[str, float]
    bound: str  # the nearest ceiling
    l1_hit_rate: float | None = None
    l2_hit_rate: float | None = None
    memory_stalls: float | None = None


def counters_of(node: Node) -> Counters:
    """Reads the counters of a kernel from an object; raises InputError."""
    of_ceiling = node.optional_numbers("of_ceiling")
    return Counters(
        **{name: node.need(name).number() for name in MEASURED},
        of_ceiling=of_ceiling,
        bound=node.need("bound").one_of(tuple(of_ceiling)),
        **{name: node.optional_number(name) for name in ("l1_hit_rate", "l2_hit_rate", "memory_stalls")},
    )
