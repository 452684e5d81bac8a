"""The ``advisor.doctor/1`` document for scripts, in SI units, with None for missing values."""

from collections.abc import Sequence
from typing import Any

from advisor.decision.first_unit import frequency
from advisor.doctor.examination import Examination
from advisor.doctor.expectation import RESPONSE_ALPHA_DEG
from advisor.report.document import instrument_document
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import PARAMETERS as QUANTITIES

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
