"""Numbers of a flight with name, source, value, 95 % interval, unit and sentence. All screens and pages state
these.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import isfinite, nan

from advisor.campaign.state import CampaignState, JudgedManeuver, LateralState
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate, TermEstimate
from advisor.words.quantities import DEG, NORMAL_95, decimals_for, maneuvers_said, signed, symbol, with_half
from advisor.words.quantities import PARAMETERS as PITCH
from advisor.words.quantities import SIDE_PARAMETERS as SIDE


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """One number about a flight, in the unit for people."""

    name: str
    """Symbol or name for people: ``M_α``, ``Dutch roll ζ``."""
    source: str
    """Origin of the number as a heading: ``Joint estimate from manoeuvres 1, 2``. Facts with equal name and
    source are one number."""
    value: float = nan
    """Value of the number; NaN if the flight does not determine it."""
    half: float = nan
    """Half-width of the 95 % interval, corrected for coloured residuals; NaN without a value."""
    unit: str = ""
    reason: str = ""
    """Reason why the flight does not determine the number."""

    @property
    def is_known(self) -> bool:
        """Whether value and interval are numbers."""
        return isfinite(self.value) and isfinite(self.half)

    @property
    def label(self) -> str:
        """Label of an axis: ``q [deg/s]``."""
        return f"{self.name} [{self.unit}]"

    @property
    def cell(self) -> str:
        """Value with the half-width of its 95 % interval: ``−48.3 ± 2.1``."""
        return cell_of(self)

    @property
    def sentence(self) -> str:
        """Value with the half-width of its 95 % interval and its unit: ``−48.3 ± 2.1 1/s²``."""
        return f"{self.cell} {self.unit.removesuffix('1')}".rstrip()


def cell_of(fact: Fact) -> str:
    """Return the value of a fact with the half-width of its 95 % interval, or a dash."""
    return with_half(fact.value, fact.half) if fact.is_known else "–"


def fact_of(name: str, source: str, value: float, std: float, unit: str = "", factor: float = 1.0) -> Fact:
    """Return a fact from value and standard deviation in SI; ``factor`` converts from SI."""
    return Fact(name=name, source=source, value=factor * value, half=NORMAL_95 * factor * std, unit=unit)


QUANTITIES = {**PITCH, **SIDE}
"""Symbol and unit of each parameter of either axis, by its name."""
LEAST_GAIN = 0.5 * NORMAL_95**2
"""Gain in log likelihood, nats, that one needless parameter exceeds in one of twenty flights. The value is
half the 95 % point of chi-squared (Wilks, 1938).
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimatedParameter(Fact):
    """One parameter of an estimate, with the aircraft file's value."""

    half_if_white: float = nan
    """Half-width of the 95 % interval from the Cramér-Rao bound; NaN without a value."""
    prior: float | None = None
    """Value of the aircraft file's model; None without one."""
    held: bool = False
    """Whether the user holds the parameter at its value."""

    @property
    def cell(self) -> str:
        """Value with the half-width of its 95 % interval, or the value at which the user holds
        the parameter.
        """
        return f"{signed(self.value, 3)}, held" if self.held else cell_of(self)

    @property
    def prior_cell(self) -> str:
        """Value of the aircraft file, written with as many decimals as the estimate."""
        return "–" if self.prior is None else signed(self.prior, decimals_for(self.half))

    @property
    def off_by(self) -> float | None:
        """Distance of the file's value from the estimate, in standard deviations."""
        if self.prior is None or not self.is_known:
            return None
        return abs(self.value - self.prior) / self.half * NORMAL_95


def estimated_parameter(
    name: str, source: str, estimate: object, prior: Mapping[str, float]
) -> EstimatedParameter:
    """Return one parameter of an estimate with the aircraft file's value, if any."""
    quantity, stated = QUANTITIES[name], prior.get(name)
    given = None if stated is None else stated * quantity.factor
    named = EstimatedParameter(name=quantity.symbol, source=source, unit=quantity.unit, prior=given)
    if not isinstance(estimate, Estimate):
        return named
    if name in estimate.not_identifiable:
        return replace(named, reason=estimate.not_identifiable[name])
    k, half = estimate.names.index(name), NORMAL_95 * quantity.factor
    return replace(
        named,
        value=float(estimate.theta[k]) * quantity.factor,
        half=half * float(estimate.std[k]),
        half_if_white=half * float(estimate.std_cr[k]),
        held=name in estimate.fixed,
    )


def joint_source(state: CampaignState | LateralState) -> str:
    """Return the name of an axis' joint estimate, for the head of a table."""
    return f"Joint estimate from {maneuvers_said(state.estimate_from)}"


def of_all(name: str, state: CampaignState | LateralState, prior: Mapping[str, float]) -> EstimatedParameter:
    """Return one parameter of a joint estimate of an axis."""
    return estimated_parameter(name, joint_source(state), state.model, prior)


def of_one(name: str, judged: JudgedManeuver | None, prior: Mapping[str, float]) -> EstimatedParameter:
    """Return one parameter of a single manoeuvre; the numbers are NaN if there is no manoeuvre."""
    if judged is None:
        return estimated_parameter(name, "no manoeuvre", None, prior)
    return estimated_parameter(
        name, f"Estimate from manoeuvre {judged.maneuver.number} alone", judged.estimate, prior
    )


def untold(estimate: Estimate) -> list[str]:
    """Return one sentence for each reason why derivatives or modes are undetermined."""
    by_reason: dict[str, list[str]] = {}
    for name, reason in estimate.not_identifiable.items():
        by_reason.setdefault(reason, []).append(symbol(name))
    sentences = [f"Not identifiable: {', '.join(names)}; {reason}." for reason, names in by_reason.items()]
    left_out = estimate.modes_left_out if isinstance(estimate, AxisEstimate) else {}
    return sentences + [f"No {mode.replace('_', ' ')} mode: {why}." for mode, why in left_out.items()]


def structure_lines(estimate: Estimate) -> list[str]:
    """Return one sentence for each parameter that the user holds, and for each term that the user adds."""
    held = [
        f"{symbol(name)} is held at {_held(name, estimate)} and not estimated." for name in estimate.fixed
    ]
    return [*held, *map(_gain_line, estimate.terms)]


def _held(name: str, estimate: Estimate) -> str:
    """Return the value at which the user holds a parameter, in the unit for people."""
    quantity = QUANTITIES[name]
    return f"{quantity.factor * estimate.value(name):.4g} {quantity.unit.removesuffix('1')}".rstrip()


def _gain_line(term: TermEstimate) -> str:
    """Return the sentence on a term: the coefficient with its interval, and whether the record supports the
    term.
    """
    half = NORMAL_95 * term.std
    said = f"The term {term.name} has the coefficient {with_half(term.value, half)}"
    if not isfinite(term.gained):
        return f"{said}; without the term there is no fit to compare with."
    gained = f"the term gains {max(term.gained, 0.0):.1f} in log likelihood for one parameter"
    if term.gained < LEAST_GAIN:
        chance = f"chance alone gains {LEAST_GAIN:.1f} in one of 20 flights"
        return f"{said}. This flight does not show the term: {gained}; {chance}."
    if abs(term.value) < half:
        return f"{said}. The 95 % interval of the coefficient contains zero, although {gained}."
    return f"{said}, the 95 % interval. The flight supports the term: {gained}."


def instrument_facts(state: CampaignState) -> list[tuple[Fact, str]]:
    """Return the nuisance parameters of the joint estimate, each with the aircraft file's value or a dash.

    Without a vane, the vane's distance is that of a vane with equal readings.
    """
    if state.model is None:
        return []
    alpha, source = state.channels.get("alpha"), joint_source(state)
    with_vane = alpha is not None and alpha.provenance in ("vane", "simulated")
    facts = []
    for nuisance in state.model.instruments:
        key = nuisance.name if with_vane or nuisance.name != "vane_arm_m" else "no_vane_arm_m"
        name, unit, factor = _INSTRUMENTS.get(key, (nuisance.name.replace("_", " "), "SI", 1.0))
        fact = fact_of(name, source, nuisance.value, nuisance.std, unit, factor)
        stated = "–" if nuisance.stated is None else signed(factor * nuisance.stated, decimals_for(fact.half))
        facts.append((fact, stated))
    return facts


_INSTRUMENTS: Mapping[str, tuple[str, str, float]] = {
    "servo_lag_s": ("servo lag, by which the estimate delays the command", "ms", 1e3),
    "command_delay_s": ("delay of the command", "ms", 1e3),
    "vane_arm_m": ("vane ahead of the centre of gravity", "m", 1.0),
    "no_vane_arm_m": ("apparent distance of the α vane ahead of the centre of gravity", "m", 1.0),
    "alpha_delay_s": ("delay of α", "ms", 1e3),
    "accelerometer_arm_m": ("accelerometer ahead of the centre of gravity", "m", 1.0),
    "steady_moment_rad": ("steady moment, as elevator", "deg", DEG),
}
"""Name, unit and factor from SI of each instrument parameter."""
