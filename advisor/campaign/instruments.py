"""Contradictions of the instruments over all manoeuvres of a campaign. All manoeuvres of a power-on share
their instruments."""

from collections.abc import Iterable
from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.findings import findings_of
from advisor.words.digits import with_half
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol


def as_known_by(maneuver: Maneuver, newest: Maneuver) -> Maneuver:
    """Return a manoeuvre with the instruments' contradictions that a later one of its power-on shows.

    A contradiction that only later manoeuvres show was not removed from the earlier manoeuvre's channels.
    """
    removed = {f.code for f in maneuver.findings if f.used}
    findings = tuple(f if f.code in removed else replace(f, used=False) for f in newest.findings)
    if maneuver.power_on != newest.power_on or _codes(findings) == _codes(maneuver.findings):
        return maneuver
    return replace(maneuver, findings=findings)


def together(
    maneuvers: Iterable[Maneuver], before_flying: Iterable[InstrumentFinding]
) -> tuple[InstrumentFinding, ...]:
    """Return each contradiction once, with the values from the newest manoeuvre that shows it."""
    by_code = {f.code: f for f in before_flying}
    for maneuver in maneuvers:
        frozen = (d.finding for d in maneuver.distrusts if d.left_out or d.stops)
        by_code |= {f.code: f for f in (*maneuver.findings, *frozen)}
    return tuple(by_code.values())


def with_fit(
    by_motion: Iterable[InstrumentFinding],
    model: Estimate | None,
    single: Iterable[Estimate | NoEstimate],
    aircraft: Aircraft,
) -> tuple[InstrumentFinding, ...]:
    """Return the findings of the motion, then the fit's findings on properties that the motion does not
    determine.

    Parameters
    ----------
    by_motion
        Findings from the motion alone, without aerodynamics.
    model
        Joint estimate over the accepted manoeuvres. The estimate's findings are in use.
    single
        Estimates of all manoeuvres. Findings of single estimates refuse manoeuvres.
    """
    by_code = {f.code: f for f in by_motion}
    findings = [] if model is None else list(findings_of(model, aircraft))
    for estimate in single:
        if isinstance(estimate, Estimate):
            findings += [f for f in findings_of(estimate, aircraft) if f.refuses]
    for finding in findings:
        by_code.setdefault(finding.code, finding)
    return tuple(by_code.values())


def side_signs(model: AxisEstimate | None, aircraft: Aircraft) -> tuple[InstrumentFinding, ...]:
    """Return the direction in which positive aileron rolls and positive rudder yaws, if the motion determines
    the direction.

    By definition a positive deflection is to the left. Without a calibration nothing states the direction;
    the derivatives then have the sign that the parameters of the outputs give. The channels keep the log's
    sign where the motion contradicts that sign.
    """
    findings = []
    for control, name, moves in (("aileron", "L_delta_a", "rolls"), ("rudder", "N_delta_r", "yaws")):
        if model is None or name in model.not_identifiable:
            continue
        value = model.value(name)
        half = NORMAL_95 * float(model.std[model.names.index(name)])
        if not half < abs(value):
            continue
        stated = getattr(aircraft, control).calibration is not None
        side, wrong = ("left", False) if value < 0.0 else ("right", True)
        shown = f"a positive one {moves} to the {side} ({symbol(name)} {with_half(value, half)})"
        text = f"{control}.calibration states the sign: {shown}"
        if not stated:
            text = f"no {control}.calibration states the sign of the {control}: {shown}"
        if wrong:
            text += "; a positive deflection should be to the left; the derivatives keep this sign"
        findings.append(
            InstrumentFinding(
                control,
                "sign",
                "left" if stated else None,
                side,
                contradicts=wrong,
                text=text,
                fix=f"give {control}.calibration with positive to the left" if wrong else "",
                used=wrong,
            )
        )
    return tuple(findings)


def _codes(findings: Iterable[InstrumentFinding]) -> set[tuple[str, bool]]:
    return {(f.code, f.refuses) for f in findings}
