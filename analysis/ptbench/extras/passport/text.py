"""Passports in words: one table a question, machines side by side."""

from collections.abc import Sequence

from ptbench.document.blocks import Section, section
from ptbench.document.table import Table, table_of
from ptbench.extras.passport.answers import Answer, answers_of
from ptbench.extras.passport.passport import Passport
from ptbench.numbers import figures
from ptbench.stats.estimates import interval_of_ratio

RULE = (
    "Times as fast: above 1 the answer is yes. Each side is the best of its variants, chosen in one run and compared "
    "in the other. A word stands where both runs agree; the 95 % interval is the second run's."
)


def sections(passports: Sequence[Passport]) -> list[Section]:
    """The machines, and a section for each question."""
    by_machine = [answers_of(passport) for passport in passports]
    asked = list(dict.fromkeys(answer.asked for answers in by_machine for answer in answers))
    return [
        section("Machines", (RULE,), _machines(passports)),
        *(section(question, (), _answers(question, passports, by_machine)) for question in asked),
    ]


def _machines(passports: Sequence[Passport]) -> Table:
    """A row a fact and a column a machine; a fact that a machine has not is left empty there."""
    facts = [_facts(passport) for passport in passports]
    names = dict.fromkeys(name for one in facts for name in one)
    rows = [(name, *(one.get(name, "") for one in facts)) for name in names]
    machines = [passport.name for passport in passports]
    return table_of(("Fact", *machines), rows, machines)


def _facts(passport: Passport) -> dict[str, str]:
    cpu = passport.chip["cpu"]
    facts = {"threads of the CPU": str(cpu["threads"])}
    for copy in (cpu["copies"][0], cpu["copies"][-1]):
        facts[f"copies of {_size(copy['bytes_per_thread'])} a thread, GB/s"] = figures(copy["gb_per_s"], 3)
    facts["multiplications and additions, 10^9/s"] = figures(cpu["gflops"], 3)
    facts["atomic additions to one counter, 10^6/s"] = figures(1e-6 * cpu["atomics_per_s"], 3)
    facts["start and end of a parallel loop, us"] = figures(cpu["fork_join_us"], 3)
    if "gpu" in passport.chip:
        gpu = passport.chip["gpu"]
        facts["copy in GPU memory, GB/s"] = figures(gpu["memory_gb_per_second"], 3)
        facts["multiply-adds of warps, 10^9/s"] = figures(gpu["fma_g_warp_instructions_per_second"], 3)
    return facts


def _size(count: int) -> str:
    kib = count // 1024
    return f"{kib} KiB" if kib < 1024 else f"{kib // 1024} MiB"


def _answers(question: str, passports: Sequence[Passport], by_machine: Sequence[Sequence[Answer]]) -> Table:
    head = ("Scene", "Machine", "Answer", "Times as fast", "95 %", "Best", "Against")
    rows = [
        (answer.scene, passport.name, *_row(answer))
        for passport, answers in zip(passports, by_machine, strict=True)
        for answer in answers
        if answer.asked == question
    ]
    scenes = list(dict.fromkeys(scene for scene, *_ in rows))
    return table_of(head, sorted(rows, key=lambda row: scenes.index(row[0])), ("Times as fast", "95 %"))


def _row(answer: Answer) -> tuple[str, ...]:
    word = answer.word + (f" ({answer.reason})" if answer.reason else "")
    if answer.sides is None:
        return word, "", "", "", ""
    second = answer.sides[1]
    return word, figures(second.ratio.value, 3), interval_of_ratio(second.ratio), second.choice, second.without
