"""``advisor gap --axis lateral``: the simulator's roll and yaw against the flight's."""

import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.side_gap import SideCompared, accepted_of, compare_side_logs
from advisor.analysis.whole_flights import read_whole
from advisor.cli.gap import compared_or_code, write_improved
from advisor.cli.improvement_export import listed, write_exports
from advisor.cli.log_options import LogsAsked
from advisor.cli.options import USAGE
from advisor.cli.proving import document as proof_document
from advisor.cli.proving import print_proof, proof_of
from advisor.cli.stages import Stages
from advisor.exports.models.proof import Proof
from advisor.exports.models.roll_and_yaw import improved_side, prove_side
from advisor.exports.models.write import ExportOrder
from advisor.gap.alternative import Weighed
from advisor.gap.candidates.distinguish import way_to_distinguish
from advisor.gap.document import changed_document, gap_document, weighed_document
from advisor.gap.inference.prior import FIELD, FieldPrior, field_prior
from advisor.gap.result import IMPROVING, Value
from advisor.gap.verdict.text import title_of_verdict
from advisor.report.console import PlainConsole
from advisor.report.gap_causes import why_of
from advisor.report.gap_reasons import how_sure, in_percent
from advisor.report.gap_sizes import named, sizes_of, with_error
from advisor.report.gap_steps import GapStep, to_decide
from advisor.side_gap.comparison import SideGap
from advisor.side_gap.diagnosis import SideDiagnosis
from advisor.side_gap.flight import LIKELY
from advisor.words.certainty import is_decided
from advisor.words.digits import with_half
from advisor.words.plain import picked, plain
from advisor.words.printable import printable
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol


def compare_lateral(
    asked: LogsAsked,
    aircraft: Aircraft,
    as_json: bool,
    prior: str | None,
    out: Path | None,
    orders: list[ExportOrder],
    proving: Sequence[str] = (),
    why: bool = False,
) -> int:
    """Compare roll and yaw of the aircraft file with the flight, print the result and write the files."""
    shares = FIELD if prior is None else field_prior(prior)
    with Stages() as tell:
        tell("reading", 0.0)
        compared = compared_or_code(
            "lateral, diagnosis",
            lambda: compare_side_logs(
                asked.logs,
                aircraft,
                asked.target_system,
                asked.marks,
                no_marks=asked.no_marks,
                prior=shares,
                progress=tell,
            ),
            as_json,
        )
    if isinstance(compared, int):
        return compared
    found = compared.gap
    improves = found.verdict in IMPROVING
    written = write_improved(out, improves, lambda: replace(improved_side(compared), pitch=None))
    outcomes = write_exports(orders, partial(improved_side, compared))
    proof = proof_of(proving, partial(_prove, asked, compared, shares))
    if as_json:
        lateral = side_gap_document(found) | {"improved_model": str(out) if written else None}
        lateral |= proof_document(proof)
        document = gap_document(None) | {"usable": True, "lateral": lateral, "exports": listed(outcomes)}
        click.echo(json.dumps(document, allow_nan=False, indent=1))
    else:
        click.echo("\n".join(side_gap_lines(found)))
        if why and found.diagnosis is not None:
            PlainConsole().print(*why_of(found.diagnosis))
        print_proof(proof)
        if written:
            click.echo(f"The improved simulator is in {printable(str(out))}.")
    return USAGE if any(one.problem for one in outcomes) else 0


def _prove(
    asked: LogsAsked,
    compared: SideCompared,
    prior: FieldPrior,
    named: Sequence[Path],
    tell: Callable[[str, float], None],
) -> Proof:
    """Fly the improved roll and yaw on the manoeuvres of logs; without any, on the last third."""
    tell("flying for the proof", 0.0)
    fresh = None
    if named:
        read = read_whole(
            named, compared.aircraft, asked.target_system, no_marks=asked.no_marks, axis="lateral"
        )
        fresh = accepted_of(read.state)
    return prove_side(compared, fresh, prior)


def side_gap_lines(found: SideGap) -> Iterator[str]:
    """Yield the sentence, the causes, each stated derivative with that of the flight, instruments, and the
    gap."""
    yield f"{_title(found)}: {found.sentence}"
    if found.diagnosis is not None:
        if found.verdict is not None:
            yield f"  {how_sure(found.diagnosis.answers)}"
        yield from _diagnosis_lines(found.diagnosis)
    for one in found.derivatives:
        differs = "  outside" if one.differs else ""
        yield (
            f"  {symbol(one.name):<6} simulator {one.given:8.4g}   flight {one.found.value:8.4g} ± "
            f"{one.half:.2g}{differs}"
        )
    if found.instruments:
        yield "Nuisance parameters of the fit, no part of the answer:"
    for name, told in found.instruments.items():
        yield f"  {_in_units(name, told)}"
    gap = found.diagnosis
    if gap is not None and gap.after and found.verdict is not None:
        listed = ", ".join(map(str, found.maneuvers))
        yield f"Gap on manoeuvres {listed}, each held out in turn, mean square over noise, minus 1:"
        for name, before in gap.before.items():
            yield f"  {name:<5} {before:8.2f} before, {gap.after[name]:.2f} after"


def _title(found: SideGap) -> str:
    """Return the title over the answer."""
    return title_of_verdict(
        found.verdict or "untested", found.diagnosis.answers if found.diagnosis is not None else ()
    )


def _to_decide(found: SideDiagnosis | None) -> GapStep | None:
    """Return the flight that separates the two likeliest answers; None where one is decided."""
    if found is None or is_decided(found.answers):
        return None
    named = {one.named: one.cause.effect for one in found.causes}
    ours, other = (named.get(words) for words, _ in found.answers[:2])
    return to_decide(found.answers, way_to_distinguish(ours, other) if ours and other else "")


def _in_units(name: str, told: Value) -> str:
    """Return a nuisance parameter with its 95 % interval, in its unit: ``rudder lag 60 ± 6 ms``."""
    if name.endswith(("_s", "_m")):
        return f"{named(name)} {with_error(name, told)}"
    return f"{name.replace('_', ' ')} {with_half(100.0 * told.value, 100.0 * NORMAL_95 * told.std)} %"


def _diagnosis_lines(found: SideDiagnosis) -> Iterator[str]:
    """Yield each likely effect with its size and the errors that it removes."""
    for one in found.causes:
        if one.cause.probability >= LIKELY:
            sizes = "; ".join(sizes_of(one.cause.parameters))
            yield f"  {one.named}: {sizes} ({in_percent(one.cause.probability)})"
            for name, before in found.peaks.items():
                after, least = (math.degrees(peaks[name]) for peaks in (one.peaks, found.peaks_by_numbers))
                yield (
                    f"    largest error of {name}: {math.degrees(before):.2f} → {after:.2f} deg/s "
                    f"({least:.2f} by fitted derivatives alone)"
                )
    for what, why in found.cannot_see.items():
        yield f"  cannot be seen: {what}, for {why}"
    if step := _to_decide(found):
        yield step.text


def side_gap_document(found: SideGap) -> dict[str, Any]:
    """Return the block ``lateral`` of ``advisor gap --json``, in SI units."""
    gaps = found.diagnosis and found.diagnosis.after and (found.diagnosis.before, found.diagnosis.after)
    by_channel, left = gaps or ({}, {})
    before, after = (float(np.mean(list(g.values()))) if g else None for g in (by_channel, left))
    shrink = None
    if before is not None and after is not None:
        percent = 100.0 * (1.0 - after / before) if before > 0.0 else None
        shrink = {"holdout": list(found.maneuvers), "before": before, "after": after, "percent": percent}
    told: dict[str, Any] = plain({
        **picked(found, "verdict sentence maneuvers not_identifiable"),
        "title": _title(found),
        "next": [] if (step := _to_decide(found.diagnosis)) is None else [step],
        "gap": {"before": before, "by_channel": by_channel, "by_channel_after": left},
        "parameters_changed": [changed_document(one) for one in found.derivatives if one.differs],
        "parameters_compared": [changed_document(one) for one in found.derivatives],
        "instruments": {n: {"value": v.value, "std": v.std} for n, v in found.instruments.items()},
        "shrink": shrink,
        **_diagnosis_document(found.diagnosis),
    })  # fmt: skip
    return told


def _diagnosis_document(found: SideDiagnosis | None) -> dict[str, Any]:
    """Return the probabilities, the causes and the largest errors, rad/s; without a diagnosis only their
    keys."""
    if found is None:
        return {
            **weighed_document(Weighed()), "where": None, "causes": [], "waterfall": [], "peaks": None,
            "cannot_see": {},
        }  # fmt: skip
    where = found.where
    return {
        **weighed_document(found),
        "where": where
        and {
            **picked(where, "block share"),
            "ranking": [{"block": block, "score": score} for block, score in where.ranking],
        },
        "causes": [
            {
                **picked(one.cause, "effect block probability present parameters"),
                **picked(one, "of name sentence peaks"),
                "held_out_nats": {"value": one.gain.total, "std": one.gain.std},
            }
            for one in found.causes
        ],
        "waterfall": [{"effect": name, "after": after} for name, after in found.waterfall],
        "peaks": {"simulator": found.peaks, "fitted_derivatives": found.peaks_by_numbers},
        "cannot_see": found.cannot_see,
    }
