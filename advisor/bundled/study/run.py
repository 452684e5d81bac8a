"""The study of Table 1 and Figure 5: independent tasks, and the report that their results make together."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from itertools import product
from typing import Generic, TypeVar

from advisor.bundled.study import text
from advisor.bundled.study.campaigns import (
    NOISE_PERCENT,
    RULES,
    CampaignBlock,
    NoiseReading,
    Outcomes,
    Scene,
    judge,
    table_blocks,
)
from advisor.bundled.study.figure import Curve, curve, in_terminal
from advisor.bundled.study.table import as_document, row

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class StudyReport:
    """Result of a study, for people and for programs."""

    lines: list[str]
    """Lines of the report for people."""
    document: dict[str, object]
    """Results of the study for programs."""
    curves: tuple[Curve, ...] = ()
    """Curves of Figure 5, if the study draws the figure."""


@dataclass(frozen=True, slots=True)
class Study(Generic[T, R]):
    """Tasks of a study, the work on one task, and the report of all results."""

    tasks: Sequence[T]
    """Tasks of several campaigns each, with all data that determine the result, including the seed."""
    work: Callable[[T], R]
    """Function of a module, so that other processes know it."""
    report: Callable[[Sequence[R]], StudyReport]
    """Function that is called with the results in the order of the tasks."""


def table_1(campaigns: int, seed: int, reading: NoiseReading = "std") -> Study[CampaignBlock, Outcomes]:
    """Return the study of Table 1 and Figure 5, with the paper's place in them."""
    scene = Scene()
    blocks = [
        block for noise in NOISE_PERCENT for block in table_blocks(scene, noise, campaigns, seed, reading)
    ]

    def report(results: Sequence[Outcomes]) -> StudyReport:
        outcomes = {
            (rule, noise): [
                outcome
                for block, judged in zip(blocks, results, strict=True)
                if block.noise_percent == noise
                for outcome in judged[rule]
            ]
            for rule, noise in product(RULES, NOISE_PERCENT)
        }
        rows = [row(rule, noise, several, scene.theta) for (rule, noise), several in outcomes.items()]
        curves = [
            curve(rule, noise, several)
            for (rule, noise), several in outcomes.items()
            if rule != "information"
        ]
        lines = [
            *text.heading(campaigns, scene, reading),
            *text.table(rows),
            *text.where_the_paper_lies(rows),
            *text.tolerances(rows),
            *(line for rule in RULES[:2] for line in [*in_terminal(curves, rule), ""]),
        ]
        document = as_document(rows, campaigns) | {
            "noise_reading": reading,
            "figure_5": [asdict(c) for c in curves],
        }
        return StudyReport(lines, document, tuple(curves))

    return Study(blocks, judge, report)
