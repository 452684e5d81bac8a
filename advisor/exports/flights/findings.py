"""Results of the flights as tables: manoeuvres with verdicts, estimates, residuals."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from advisor.aircraft.reference import PARAMETERS
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.exports.flights.table import Column, FlightTable, counts, numbers, texts, truths
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import UNITS
from advisor.model.axes.lateral import LATERAL
from advisor.model.outputs import OUTPUTS
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.words.quantities import SIDE_PARAMETERS

PARAMETER_UNITS = dict(
    zip(PARAMETERS, ("rad/s", "1/s", "1", "1/s", "rad/s^2", "1/s^2", "1/s", "1/s^2"), strict=True)
)
"""SI units of the eight parameters θ, Eqs. (1)-(3)."""
SIDE_UNITS = {name: quantity.unit.replace("²", "^2") for name, quantity in SIDE_PARAMETERS.items()}
"""SI units of the derivatives of roll and yaw."""
JOINT = 0
"""Number of the joint estimate over the accepted manoeuvres."""
_BY_ROW = "the column unit"
_MEASURES = {
    "rms": "root mean square of the residual",
    "tic": "Theil's inequality coefficient, 0 to 1",
    "r2": "share of the measured variance explained",
}


class _Axis(NamedTuple):
    """Results of one axis for the tables."""

    judged: Sequence[JudgedManeuver]
    model: Estimate | None
    units: Mapping[str, str]
    """SI unit of each parameter, by its name."""
    outputs: Sequence[str]
    prefix: str = ""
    """Beginning of the axis' table names."""


def findings(state: CampaignState, record_of: Mapping[tuple[int, int], int]) -> Iterator[FlightTable]:
    """Yield the tables of pitch, and those of roll and yaw if a lateral manoeuvre was flown.

    Parameters
    ----------
    record_of
        Number of each record by (flight, power-on), both counted from 0.
    """
    axes = [_Axis(state.maneuvers, state.model, PARAMETER_UNITS, OUTPUTS)]
    side = state.lateral
    if side is not None and side.maneuvers:
        axes.append(_Axis(side.maneuvers, side.model, SIDE_UNITS, LATERAL.outputs, "lateral_"))
    for axis in axes:
        yield _maneuvers(axis, record_of)
        yield _estimates(axis)
        yield from _residuals(axis, record_of)


def _maneuvers(axis: _Axis, record_of: Mapping[tuple[int, int], int]) -> FlightTable:
    """Return a table with a row for each manoeuvre: verdict, reasons and fit."""
    judged = axis.judged
    spans = [m.maneuver.span for m in judged]
    verdicts = [m.verdict for m in judged]
    columns = [
        Column("maneuver", counts([m.maneuver.number for m in judged]), "", "number"),
        Column(
            "record", _records([m.maneuver.power_on for m in judged], record_of), "", "number of the record"
        ),
        Column(
            "record_from_boot_s", numbers([s.record_from_s for s in spans]), "s", "first stamp of the fit"
        ),
        Column("start_boot_s", numbers([s.start_s for s in spans]), "s", "onset of the first step"),
        Column("last_step_boot_s", numbers([s.last_step_s for s in spans]), "s", "onset of the last step"),
        Column("end_boot_s", numbers([s.end_s for s in spans]), "s", "end of the free response"),
        Column("input", texts([s.kind for s in spans]), "", "kind of input"),
        Column("mode", texts([m.maneuver.mode for m in judged]), "", "flight mode"),
        Column("accepted", truths([v.accepted for v in verdicts]), "", "whether the verdict accepts"),
        Column("sentence", texts([v.sentence for v in verdicts]), "", "verdict as the pilot reads it"),
        Column(
            "reason_codes", texts([" ".join(r.code for r in v.reasons) for v in verdicts]), "", "stable codes"
        ),
        Column(
            "reasons", texts(["; ".join(r.text for r in v.reasons) for v in verdicts]), "", "why rejected"
        ),
        Column(
            "cautions",
            texts(["; ".join(v.cautions) for v in verdicts]),
            "",
            "cautions that do not change the verdict",
        ),
        Column(
            "excluded_because", texts([m.excluded_because or "" for m in judged]), "", "why excluded by hand"
        ),
        Column("closed_by", texts([s.closed_by for s in spans]), "", "why the record ends"),
        Column(
            "cost", numbers([e.cost if (e := _estimate(m)) else None for m in judged]), "", "J of Eq. (7)"
        ),
    ]
    for output in axis.outputs:
        fits = [e.fits[0].get(output) if (e := _estimate(m)) else None for m in judged]
        columns += _measures(output, fits) if any(fits) else []
    return FlightTable(f"{axis.prefix}maneuvers", "A row is a manoeuvre.", tuple(columns))


def _estimates(axis: _Axis) -> FlightTable:
    """Return a table with a row for each parameter of each estimate, and its row of the covariance."""
    estimates = [(m.maneuver.number, e) for m in axis.judged if (e := _estimate(m))]
    if axis.model is not None:
        estimates.append((JOINT, axis.model))
    rows = [
        (number, e, name)
        for number, e in estimates
        for name in (*axis.units, *(instrument.name for instrument in e.instruments))
    ]

    def by_row(values: str, *of: int) -> NDArray[np.float64]:
        """Return an attribute of the estimates by row, shape (n,); NaN for an unidentifiable parameter."""
        return numbers([_told(e, name, values, of) for _, e, name in rows])

    units = texts([axis.units.get(name, name.rpartition("_")[2]) for _, _, name in rows])
    reasons = texts([e.not_identifiable.get(name, "") for _, e, name in rows])
    speeds = numbers([e.airspeed_m_s for _, e, _ in rows])
    which = f"number; {JOINT} is the joint estimate over the accepted manoeuvres"
    columns = [
        Column("maneuver", counts([number for number, _, _ in rows]), "", which),
        Column("parameter", texts([name for _, _, name in rows]), "", "name of the parameter"),
        Column("unit", units, "", "SI unit of the value"),
        Column("value", by_row("theta"), _BY_ROW, "estimate"),
        Column("std", by_row("std"), _BY_ROW, "standard deviation, corrected for coloured residuals"),
        Column("std_cr", by_row("std_cr"), _BY_ROW, "plain Cramér-Rao bound"),
        Column("reason", reasons, "", "reason for a missing value"),
        Column("airspeed_m_s", speeds, "m/s", "air speed at which the derivatives are given"),
    ]
    for k, (name, its) in enumerate(axis.units.items()):
        unit = f"{_BY_ROW} times {its}"
        columns.append(Column(f"covariance_{name}", by_row("covariance", k), unit, f"covariance with {name}"))
    about = "A row is one parameter of one estimate: the derivatives, then the instruments."
    return FlightTable(f"{axis.prefix}estimates", about, tuple(columns))


def _told(e: Estimate, name: str, values: str, of: tuple[int, ...]) -> float | None:
    """Return an attribute of one parameter of an estimate; None for an unidentifiable parameter."""
    if name in e.names:
        return None if name in e.not_identifiable else getattr(e, values)[(e.names.index(name), *of)]
    instrument = e.instrument(name)
    attribute = {"theta": "value", "std": "std"}.get(values)
    return None if instrument is None or attribute is None else getattr(instrument, attribute)


def _residuals(axis: _Axis, record_of: Mapping[tuple[int, int], int]) -> Iterator[FlightTable]:
    """Yield a table for each output: measured, fitted and residual values of accepted manoeuvres, at the
    output's stamps.
    """
    accepted = [(m.maneuver, e) for m in axis.judged if m.verdict.accepted and (e := _estimate(m))]
    for output in axis.outputs:
        fits = [(maneuver, e.fits[0][output]) for maneuver, e in accepted if output in e.fits[0]]
        if not fits:
            continue
        sizes, unit = [len(fit.t) for _, fit in fits], UNITS[output]

        def joined(name: str, fits: Sequence[tuple[Maneuver, ChannelFit]] = fits) -> NDArray[np.float64]:
            return np.concatenate([getattr(fit, name) for _, fit in fits])

        columns = (
            Column("maneuver", np.repeat([m.number for m, _ in fits], sizes).astype(np.int64), "", "number"),
            Column(
                "record",
                np.repeat(_records([m.power_on for m, _ in fits], record_of), sizes),
                "",
                "number of the record",
            ),
            Column("t_boot_s", joined("t"), "s", "vehicle time since power-on"),
            Column("measured", joined("measured"), unit, f"measured {output}"),
            Column("fitted", joined("fitted"), unit, f"{output} of the fit of lowest cost"),
            Column("residual", joined("residual"), unit, "measured minus fitted"),
        )
        yield FlightTable(f"{axis.prefix}residuals_{output}", f"A row is a sample of {output}.", columns)


def _estimate(judged: JudgedManeuver) -> Estimate | None:
    return judged.estimate if isinstance(judged.estimate, Estimate) else None


def _records(
    power_ons: Sequence[tuple[int, int]], record_of: Mapping[tuple[int, int], int]
) -> NDArray[np.int64]:
    return counts([record_of[power_on] for power_on in power_ons])


def _measures(output: str, fits: Sequence[ChannelFit | None]) -> list[Column]:
    return [
        Column(
            f"{measure}_{output}",
            numbers([getattr(fit, measure) if fit else None for fit in fits]),
            UNITS[output] if measure == "rms" else "1",
            f"{about}, {output}",
        )
        for measure, about in _MEASURES.items()
    ]
