"""Fly blind cases of every generator and score the diagnosis.

    python -m benchmarks.gap_score --each 20 --seed 5150     # about ten seconds a flight and core
    python -m benchmarks.gap_score --seed 5150 --table       # the table of the answers kept so far
    python -m benchmarks.gap_score --each 10 --seed 5150 --only-world    # the telemetry of the world alone
    python -m benchmarks.gap_score --each 10 --seed 5150 --write docs/data/gap-fresh.md    # for the pages

The flights are drawn from the seed in each generator's own mixture, with natural nuisances, and with more
flights that have no name for their cause. In the strata of the world all natural numbers act together
(``benchmarks.sealed.world``); the table counts these flights apart. ArduPlane flies where its simulator lies
next to the checkout. A process is given the log and the aircraft file of a case and nothing else. Answers are
kept in ``build/gap-score``, a line a flight: a run goes on where it stopped.
"""

import json
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Any

import click
import numpy as np

from advisor.cli.running import runner_of
from advisor.gap.inference.prior import FIELD
from benchmarks.gap_draws import DRAWS, drawn
from benchmarks.real import commit
from benchmarks.sealed.answer import answer
from benchmarks.sealed.generator import COMPARED
from sim.sealed.cases import SealedCase, write_case
from sim.sealed.score import wilson

SURE = 0.9
"""Probability from which a reader takes an answer for sure."""
LEAST_SHARE = 1e-3
"""Probability below which the log score of an answer falls no further."""
FOLDER = Path("build") / "gap-score"
_NAME = 56
"""Width of a figure's name in the table."""


def answered(name: str, case: SealedCase) -> dict[str, Any]:
    """Return the answer to a case with its key."""
    with tempfile.TemporaryDirectory() as folder:
        write_case(case, Path(folder) / "case")
        document, seconds = answer(Path(folder) / "case", case.truth.get("axis", "pitch"))
    kept = ("verdict", "probabilities", "gap", "shrink")
    return {
        "case": name,
        "truth": json.loads(json.dumps(case.truth, default=float)),
        "answer": {key: document.get(key) for key in kept} | {"first": _first(document)},
        "seconds": seconds,
    }


def _first(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return name, block and sizes of the first answer of a document."""
    verdict = document.get("verdict") or "none"
    if verdict == "effect":
        cause = document["causes"][0]
        return {"name": cause.get("name", cause["effect"]), "sizes": cause["parameters"]}
    return {"name": verdict, "block": (document.get("where") or {}).get("block"), "sizes": {}}


def is_right(one: Mapping[str, Any]) -> bool:
    """Return whether the first answer is right.

    Of two effects either is right. Without an effect the air, where it moved, is right too, and so is what
    the log has because of its generation, as the lag of an angle of attack that an autopilot computes.
    Without a name "unknown" is right in any block.
    """
    truth, name = one["truth"], one["answer"]["first"]["name"]
    kind = truth["kind"]
    if kind == "outside":
        return bool(name == "unknown")
    if kind in ("one", "two"):
        return name in truth["effects"]
    return name == kind or (kind == "none" and name in _natural(truth))


def _natural(truth: Mapping[str, Any]) -> Sequence[str]:
    """Return the effects that a log has although nothing is withheld."""
    return (*truth["background"], *truth.get("also_true", ()))


def is_alarm(one: Mapping[str, Any]) -> bool:
    """Return whether the answer to a flight with nothing withheld is an effect, or an effect without a
    name."""
    return not is_right(one) and one["answer"]["first"]["name"] != "parameters"


def log_score(one: Mapping[str, Any]) -> float:
    """Return the log of the probability that the answer gives to the truth, nats, at least that of .001."""
    told = one["answer"]["probabilities"]
    if told is None:
        return float(np.log(LEAST_SHARE))
    kind, effects = one["truth"]["kind"], told["effects"]
    if kind in ("one", "two"):
        p = sum(effects.get(name, 0.0) for name in one["truth"]["effects"])
    elif kind == "outside":
        p = sum(told["unknown"].values())
    else:
        natural = _natural(one["truth"]) if kind == "none" else ()
        p = told[kind] + sum(effects.get(name, 0.0) for name in natural)
    return float(np.log(max(p, LEAST_SHARE)))


def in_the_field(flights: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """Return weights (flights,) that give each kind of cause its share in the field prior.

    A probability is calibrated where kinds are as frequent as its prior says, and the strata draw far more
    flights without a name.
    """
    names = {"one": "effect", "two": "effect", "outside": "unknown"}
    kinds = [names.get(kind, kind) for kind in (f["truth"]["kind"] for f in flights)]
    return np.array([getattr(FIELD, kind) / kinds.count(kind) for kind in kinds])


def stated(one: Mapping[str, Any]) -> float:
    """Return the probability that the answer states for itself."""
    told = one["answer"]["probabilities"]
    name = one["answer"]["first"]["name"]
    if told is None:
        return 0.0
    if name == "unknown":
        return float(sum(told["unknown"].values()))
    return float(told["effects"].get(name, told.get(name) or 0.0))


def follows(one: Mapping[str, Any]) -> bool:
    """Return whether no other answer is likelier than the one that is given."""
    told = one["answer"]["probabilities"]
    if told is None:
        return True
    others = [told["none"], told["parameters"], sum(told["unknown"].values()), *told["effects"].values()]
    return stated(one) >= max(others) - 1e-9


def sizes_inside(one: Mapping[str, Any]) -> Iterator[bool]:
    """Yield whether each size of a right first cause lies within its 95 % interval."""
    first, truth = one["answer"]["first"], one["truth"]["effects"]
    if not isinstance(truth, Mapping):
        return
    for name, value in truth.get(first["name"], {}).items():
        found = first["sizes"].get(name)
        if name in COMPARED and found is not None:
            yield abs(found["value"] - value) <= 1.96 * found["std"]


def table(flights: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the rows of the table: a figure, its 95 % interval and its number."""

    def share(name: str, hits: Sequence[bool]) -> str:
        if not hits:
            return f"{name:{_NAME}s} no case"
        low, high = wilson(sum(hits), len(hits))
        return f"{name:{_NAME}s} {sum(hits):4d} of {len(hits):<4d} [{100 * low:3.0f}, {100 * high:3.0f}] %"

    worldly = [f for f in flights if "world" in f["truth"]]
    flights = [f for f in flights if "world" not in f["truth"]]
    for generator in DRAWS:
        mine = [f for f in worldly if f["case"].startswith(generator)]
        if not mine:
            continue
        yield share(f"in the world: first answer right, {generator}", [is_right(f) for f in mine])
        alarms = [is_alarm(f) for f in mine if f["truth"]["kind"] == "none"]
        yield share(f"in the world: false alarms, {generator}", alarms)
    if not flights:
        return
    for generator in DRAWS:
        mine = [f for f in flights if f["case"].startswith(generator)]
        if not mine:
            continue
        yield share(f"first answer right, {generator}", [is_right(f) for f in mine])
        with_names = [is_right(f) for f in mine if f["truth"]["kind"] != "outside"]
        yield share(f"  without the nameless, {generator}", with_names)
        alarms = [is_alarm(f) for f in mine if f["truth"]["kind"] == "none"]
        yield share(f"  false alarms, nothing withheld, {generator}", alarms)
        sure = [is_right(f) for f in mine if stated(f) >= SURE]
        yield share(f"  right where P is at least .9, {generator}", sure)
        score = float(np.mean([log_score(f) for f in mine]))
        yield f"{f'  log score of the truth, {generator}':{_NAME}s} {score:.2f} nats a flight"
    kinds = {k: [f for f in flights if f["truth"]["kind"] == k] for k in ("none", "outside", "parameters")}
    yield share("false alarms, nothing withheld", [is_alarm(f) for f in kinds["none"]])
    yield share("wrong numbers, told", [is_right(f) for f in kinds["parameters"]])
    outside = [(f["answer"]["first"]["name"], f["truth"]["background"]) for f in kinds["outside"]]
    yield share("without a name: unknown", [name == "unknown" for name, _ in outside])
    seen = [(f["answer"]["gap"] or {}).get("before", 0.0) > 1.0 for f in kinds["outside"]]
    told = [name == "unknown" for (name, _), is_seen in zip(outside, seen, strict=True) if is_seen]
    yield share("  where the gap exceeds the noise: unknown", told)
    # Air that moved as well is no wrong name.
    named = [name not in ("unknown", "none", "parameters", *air) for name, air in outside]
    yield share("without a name: another name", named)
    yield share("right where P is at least .9", [is_right(f) for f in flights if stated(f) >= SURE])
    sure = np.array([stated(f) >= SURE for f in flights]) * in_the_field(flights)
    held = float(sure @ np.array([is_right(f) for f in flights]) / max(np.sum(sure), 1e-12))
    yield f"{'  the same, with the kinds as frequent as in the prior':{_NAME}s} {100.0 * held:.0f} %"
    yield share("verdict follows from the probabilities", [follows(f) for f in flights])
    yield share("sizes inside 95 %", [inside for f in flights if is_right(f) for inside in sizes_inside(f)])
    chances = np.array([stated(f) for f in flights])
    right = np.array([is_right(f) for f in flights], float)
    yield (
        f"{'calibration error, Brier score of the answer':{_NAME}s} {calibration_error(chances, right):.3f}, "
        + (f"{np.mean((chances - right) ** 2):.3f}")
    )
    yield f"{'mean probability where right':{_NAME}s} {np.mean(chances[right > 0]):.2f}"
    seconds = [f["seconds"] for f in flights]
    said = f"{np.median(seconds):.1f} s, at most {np.max(seconds):.1f} s"
    yield f"{'processor time of a diagnosis, median':{_NAME}s} {said}"


def calibration_error(told: np.ndarray, right: np.ndarray) -> float:
    """Return the mean difference of stated probability and share of right answers, over five equal parts."""
    parts = np.array_split(np.argsort(told), 5)
    return float(sum(len(p) * abs(np.mean(told[p]) - np.mean(right[p])) for p in parts if len(p)) / len(told))


@click.command
@click.option("--each", type=click.IntRange(1), default=20, show_default=True, help="Flights a generator.")
@click.option("--seed", type=click.IntRange(0), required=True, help="Equal seeds give equal flights.")
@click.option("--label", default="", help="Name of the answers' file, to compare two states of the code.")
@click.option("--table", "only_table", is_flag=True, help="Print the table and fly nothing.")
@click.option(
    "--generator", "generators", multiple=True, type=click.Choice(list(DRAWS)), help="Default: all."
)
@click.option("--only-world", is_flag=True, help="Fly only the strata with the telemetry of the world.")
@click.option("--workers", type=click.IntRange(1), help="Processes; by default one a core.")
@click.option("--write", "page", type=click.Path(path_type=Path), help="Page that receives the table.")
def main(
    each: int,
    seed: int,
    label: str,
    only_table: bool,
    generators: Sequence[str],
    only_world: bool,
    workers: int | None,
    page: Path | None,
) -> None:
    """Fly, answer and score."""
    kept = FOLDER / f"{seed}{label}.jsonl"
    kept.parent.mkdir(parents=True, exist_ok=True)
    lines = kept.read_text(encoding="utf-8").splitlines() if kept.exists() else []
    flights = [json.loads(line) for line in lines]
    done = {flight["case"] for flight in flights}
    if not only_table:
        every = drawn(each, seed, generators or tuple(DRAWS), only_world)
        cases = [pair for pair in every if pair[0] not in done]
        with kept.open("a", encoding="utf-8") as out:
            for _, result in runner_of(workers, None)(_answered, cases):
                if isinstance(result, Exception):
                    raise result
                out.write(json.dumps(result) + "\n")
                out.flush()
                flights.append(result)
                print(result["case"], result["answer"]["first"]["name"], file=sys.stderr)
    rows = list(table(flights))
    click.echo("\n".join(rows))
    if page is not None:
        page.write_text(in_markdown(rows, seed, len(flights)), encoding="utf-8")


def in_markdown(rows: Sequence[str], seed: int, count: int) -> str:
    """Return the rows of the table as a page, with seed, number of flights, day and commit."""
    lines = [f"| {row[:_NAME].strip()} | {' '.join(row[_NAME:].split())} |" for row in rows]
    source = f"{count} flights, seed {seed}, {date.today().isoformat()}, commit `{commit()}`."
    return "\n".join(["| figure | value, 95 % interval |", "|---|---|", *lines, "", source, ""])


def _answered(pair: tuple[str, SealedCase]) -> dict[str, Any]:
    return answered(*pair)


if __name__ == "__main__":
    main()
