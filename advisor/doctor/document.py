"""The ``advisor.doctor/1`` document for scripts, in SI units, with None for missing values."""

from collections.abc import Sequence
from typing import Any

from advisor.doctor.examination import Examination, Limit
from advisor.doctor.expectation import RESPONSE_ALPHA_DEG, frequency
from advisor.report.document import NORMAL_95, instrument_document, number
from advisor.report.text import UNITS
from advisor.words.problems import Problem

SCHEMA = "advisor.doctor/1"


def doctor_document(
    findings: Examination | None, problem: Problem | None = None, commands: Sequence[str] = ()
) -> dict[str, Any]:
    """Build the document of ``advisor doctor --json``.

    Parameters
    ----------
    findings
        Findings of the examination. None when nothing was heard; ``problem`` then gives the reason.
    commands
        Commands to type next.
    """
    if findings is None:
        assert problem is not None
        told = {"code": problem.code, "text": problem.text, "fix": problem.fix}
        return {
            "schema": SCHEMA,
            "usable": False,
            "verdict": "not usable",
            "problems": [told],
            "vehicle": None,
            "messages": [],
            "elevator": None,
            "alpha": None,
            "limits": [told],
            "instruments": [],
            "expected_std": None,
            "expected_ci95": None,
        }
    vehicle, elevator, alpha, clocks = findings.vehicle, findings.elevator, findings.alpha, findings.clocks
    stopping = [limit for limit in findings.limits if limit.stops]
    expectation = findings.expectation
    return {
        "schema": SCHEMA,
        "usable": not stopping,
        "verdict": findings.verdict,
        "problems": [{"code": limit.code, "text": limit.text, "fix": limit.fix} for limit in stopping],
        "vehicle": vehicle
        and {
            "system": vehicle.system,
            "component": vehicle.component,
            "autopilot": vehicle.autopilot,
            "firmware": vehicle.firmware,
        },
        "messages": [
            {
                "name": arrival.name,
                "count": arrival.count,
                "rate_hz": number(arrival.rate_hz),
                "lowest_hz": number(arrival.lowest_hz),
                "jitter_ms": number(arrival.jitter_ms),
                "largest_gap_s": number(arrival.largest_gap_s),
                "renewed_hz": number(arrival.renewed_hz),
            }
            for arrival in findings.messages
        ],
        "clocks": clocks
        and {
            "boots": clocks.boots,
            "drift_percent": number(clocks.drift_percent),
            "arrival_jitter_ms": number(clocks.arrival_jitter_ms),
            "strayed": dict(clocks.strayed),
        },
        "elevator": elevator
        and {
            "output": elevator.outputs[0],
            "outputs": list(elevator.outputs),
            "resolution_deg": number(elevator.resolution_deg),
            "calibrated": elevator.calibrated,
        },
        "alpha": alpha
        and {
            "source": alpha.source,
            "provenance": alpha.provenance,
            "renewed_hz": number(alpha.renewed_hz),
        },
        "limits": [_limit(limit) for limit in findings.limits],
        "instruments": [instrument_document(found) for found in findings.instruments],
        "notes": list(findings.notes),
        "next": list(commands),
        "expected_std": expectation and {name: number(std) for name, std in expectation.std.items()},
        "expected_ci95": expectation
        and {
            name: {"half": number(NORMAL_95 * std), "unit": UNITS[name].replace("deg", "rad")}
            for name, std in expectation.std.items()
        },
        "expected_for": expectation
        and {
            "input": "3-2-1-1",
            "unit_s": number(expectation.unit_s),
            "amplitude_deg": number(expectation.amplitude_deg),
            "alpha_change_deg": RESPONSE_ALPHA_DEG,
            "noise": {name: number(std) for name, std in findings.assumed.noise.items()},
            "model": findings.assumed.source,
            "natural_frequency_rad_s": number(frequency(findings.assumed.model)),
        },
    }


def _limit(limit: Limit) -> dict[str, Any]:
    return {
        "code": limit.code,
        "text": limit.text,
        "fix": limit.fix,
        "stops": limit.stops,
        "std_ratio": {name: number(ratio) for name, ratio in limit.std_ratio.items()},
    }
