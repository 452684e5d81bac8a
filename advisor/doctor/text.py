"""The findings as text (first the verdict, then the remedies, then the tables), and as a document."""

import math
from collections.abc import Sequence
from typing import Any

from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text

from advisor.aircraft.reference import PARAMETERS
from advisor.decision.first_unit import frequency
from advisor.doctor.examination import Examination, Limit
from advisor.doctor.expectation import RESPONSE_ALPHA_DEG
from advisor.doctor.limits import STRAYED_SHARE
from advisor.report.document import instrument_document
from advisor.report.text import message_table
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem, printable
from advisor.words.quantities import NORMAL_95
from advisor.words.quantities import PARAMETERS as QUANTITIES

_SIGNS = {"ready": "✓", "usable with limits": "!", "not usable": "✗"}
_STYLES = {"ready": "bold green", "usable with limits": "bold yellow", "not usable": "bold red"}
_NOTABLE_COST = 1.1


class ExaminationText:
    """Renders an examination with rich."""

    def __init__(self, findings: Examination, commands: Sequence[str] = ()) -> None:
        self._findings, self._commands = findings, commands

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        findings = self._findings
        yield Text(f"{_SIGNS[findings.verdict]} {findings.verdict.upper()}", style=_STYLES[findings.verdict])
        for limit in findings.limits:
            yield from _told(limit)
        yield from (Text(f"  note: {note}") for note in findings.notes)
        yield Text()
        yield Text(self._who())
        yield Text(self._elevator())
        yield Text(self._alpha())
        if findings.airspeed_m_s is not None:
            low, high = findings.airspeed_m_s
            yield Text(f"air speed  {low:.1f} to {high:.1f} m/s read in flight")
        yield Text(self._clocks())
        yield Text()
        yield message_table("messages", plain(findings.messages)).on_console()
        if findings.expectation is not None:
            yield Text()
            yield Text(
                f"Expected errors of one 3-2-1-1, steps of {findings.expectation.unit_s:.2f} s and "
                f"±{findings.expectation.amplitude_deg:.1f} deg, computed from {findings.assumed.source}, "
                f"natural frequency {frequency(findings.assumed.model):.1f} rad/s. "
                "Half of the 95 % interval (1.96 standard deviations), if the model is complete; analyze "
                "adds the error of the model:"
            )
            for name in PARAMETERS:
                quantity = QUANTITIES[name]
                half = NORMAL_95 * findings.expectation.std[name] * quantity.factor
                unit = "" if quantity.unit == "1" else quantity.unit
                said = f"± {half:.2g} {unit}" if math.isfinite(half) else "not identifiable at these rates"
                yield Text(f"  {quantity.symbol:<10} {said}".rstrip())
        if self._commands:
            yield Text("\nNext:")
            yield from (Text(f"  {printable(command)}") for command in self._commands)

    def _who(self) -> str:
        vehicle = self._findings.vehicle
        if vehicle is None:
            return "vehicle    none heard"
        return f"vehicle    {vehicle}, firmware {vehicle.firmware or 'unknown'}"

    def _elevator(self) -> str:
        elevator = self._findings.elevator
        if elevator is None:
            return "elevator   not found"
        outputs = " + ".join(map(str, elevator.outputs))
        scale = "calibrated" if elevator.calibrated else "not calibrated"
        return f"elevator   output {outputs}, {scale}, {elevator.resolution_deg:.3f} deg per microsecond"

    def _alpha(self) -> str:
        alpha = self._findings.alpha
        if alpha is None:
            return "alpha      none"
        return f"alpha      {alpha.source}, {alpha.provenance}, new values at {alpha.renewed_hz:.1f} Hz"

    def _clocks(self) -> str:
        clocks = self._findings.clocks
        if clocks is None or not math.isfinite(clocks.drift_percent):
            return "clocks     cannot be compared"
        strayed = max(clocks.strayed.values(), default=0.0)
        consistent = "inconsistent" if strayed > STRAYED_SHARE else "consistent"
        return (
            f"clocks     {consistent}, drift {clocks.drift_percent:+.3f} %, arrival within "
            f"{clocks.arrival_jitter_ms:.1f} ms, {clocks.boots} power-on{'s' if clocks.boots > 1 else ''}"
        )


def _told(limit: Limit) -> list[Text]:
    """Return the text lines of a defect: its sentence, its remedy and its cost."""
    lines = [Text(f"  {'✗' if limit.stops else '!'} {limit.text}."), Text(f"    -> {limit.fix}.")]
    worst = sorted(limit.std_ratio.items(), key=lambda item: -item[1])[:3]
    notable = [f"{QUANTITIES[name].symbol} {ratio:.1f}" for name, ratio in worst if ratio >= _NOTABLE_COST]
    if notable:
        lines.append(Text(f"    costs: expected errors times {', '.join(notable)}"))
    return lines


SCHEMA = "advisor.doctor/1"


def doctor_document(
    findings: Examination | None, problem: Problem | None = None, commands: Sequence[str] = ()
) -> dict[str, Any]:
    """Build the document of ``advisor doctor --json``.

    Parameters
    ----------
    findings
        Findings of the examination. None when nothing was heard; ``problem`` then gives the reason.
    """
    if findings is None:
        assert problem is not None
        entry = plain(problem)
        return {
            "schema": SCHEMA,
            "usable": False,
            "verdict": "not usable",
            "problems": [entry],
            "vehicle": None,
            "messages": [],
            "elevator": None,
            "alpha": None,
            "limits": [entry],
            "instruments": [],
            "expected_std": None,
            "expected_ci95": None,
        }
    elevator = findings.elevator
    stopping = [limit for limit in findings.limits if limit.stops]
    expectation = findings.expectation
    return {
        "schema": SCHEMA,
        "usable": not stopping,
        "verdict": findings.verdict,
        "problems": [picked(limit, "code text fix") for limit in stopping],
        "vehicle": picked(findings.vehicle, "system component autopilot firmware"),
        "messages": plain(findings.messages),
        "clocks": plain(findings.clocks),
        "elevator": elevator
        and {"output": elevator.outputs[0], **picked(elevator, "outputs resolution_deg calibrated")},
        "alpha": plain(findings.alpha),
        "airspeed_m_s": plain(findings.airspeed_m_s),
        "limits": plain(findings.limits),
        "instruments": [instrument_document(finding) for finding in findings.instruments],
        "notes": list(findings.notes),
        "next": list(commands),
        "expected_std": expectation and plain(expectation.std),
        "expected_ci95": expectation
        and {
            name: {"half": plain(NORMAL_95 * std), "unit": QUANTITIES[name].unit.replace("deg", "rad")}
            for name, std in expectation.std.items()
        },
        "expected_for": expectation
        and {
            "input": "3-2-1-1",
            "unit_s": plain(expectation.unit_s),
            "amplitude_deg": plain(expectation.amplitude_deg),
            "alpha_change_deg": RESPONSE_ALPHA_DEG,
            "noise": plain(findings.assumed.noise),
            "model": findings.assumed.source,
            "natural_frequency_rad_s": plain(frequency(findings.assumed.model)),
        },
    }
