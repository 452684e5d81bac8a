"""Analyses of logs and estimates of manoeuvres, made once a test run, whichever of its processes asks first.

Faces and exports are tested on what an analysis says, campaigns on what follows from an estimate. The
estimator is the subject of other tests, which call it themselves.
"""

import fcntl
import pickle
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache, partial, wraps
from hashlib import sha256
from inspect import signature
from io import BytesIO
from types import SimpleNamespace
from typing import Any, TypeVar, cast

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis import axis_flown, gap, whole_flights
from advisor.analysis import axis_flown as side_gap
from advisor.analysis.marks_file import LogSeries
from advisor.analysis.whole_flights import WholeFlights
from advisor.campaign import axis_campaign, joint_estimate, single_maneuver
from advisor.cli import analyze, axis_gap, page_content
from advisor.doctor import expectation
from advisor.exports.models.jsbsim import source as jsbsim_run
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.axis.estimator import JointSearch
from advisor.oem.estimate import NoEstimate
from advisor.simulators.linear import LinearSimulator
from tests.flights import SHARED

Result = TypeVar("Result")


def use_recorded(patch: pytest.MonkeyPatch) -> None:
    """Let commands read the analysis of a log that another test of this run has analysed already."""
    whole, compared = _once(whole_flights.read_whole), _once(gap.compare_logs)
    for module in (whole_flights, page_content, side_gap, axis_flown, axis_gap):
        patch.setattr(module, "read_whole", whole)
    patch.setattr(gap, "compare_logs", compared)
    patch.setattr(gap, "compare_flown", _diagnosed_once(gap.compare_flown))
    patch.setattr(analyze, "_analyze", _once(analyze._analyze))


def _once(function: Callable[..., Result]) -> Callable[..., Result]:
    """The function, whose result is kept by its arguments and by the content of its logs."""
    made_by_simulator = gap.compare_logs

    @wraps(function)
    def recalled(*arguments: Any, **settings: Any) -> Result:
        bound = signature(function).bind(*arguments, **settings)
        bound.apply_defaults()
        asked = {name: _deciding(value) for name, value in bound.arguments.items()}
        given = asked.pop("logs", None) or bound.arguments["series"].logs
        of_user = getattr(asked.get("aircraft"), "simulator", None) if function is made_by_simulator else None
        if of_user not in (None, "linear") or not all(log.exists() for log in given):
            return function(*arguments, **settings)  # a user's simulator flies anew; a missing log says so
        read = [(log.name, log.read_bytes()) for log in given]
        by_hand = LogSeries(given).read_by_hand()
        key = (function.__qualname__, asked, read, by_hand)
        result: Any = _made_once(key, lambda: function(*arguments, **settings))
        # Copies of one log in several folders have one analysis.
        if isinstance(result, WholeFlights):
            result = replace(result, logs=tuple(LogSeries(given).logs))
        return cast("Result", result)

    return recalled


def _diagnosed_once(compare_flown: Callable[..., Result]) -> Callable[..., Result]:
    """The diagnosis, kept by the manoeuvres and the aircraft; that of a user's simulator is made anew."""

    def recalled(flown: Any, aircraft: Aircraft, simulator: Any, *settings: Any) -> Result:
        deciding = [setting for setting in settings if not callable(setting)]
        make = partial(compare_flown, flown, aircraft, simulator, *settings)
        if simulator is not None and not isinstance(simulator, LinearSimulator):
            return make()
        return _made_once((compare_flown.__qualname__, flown, aircraft, simulator, deciding), make)

    return recalled


def record_estimates(patch: pytest.MonkeyPatch) -> None:
    """Let campaigns, the doctor and exports read estimates and slopes that another test of this run made."""
    for module, name in ((single_maneuver, "estimate"), (axis_campaign, "estimate_axis")):
        patch.setattr(module, name, _estimated_once(getattr(module, name)))
    patch.setattr(expectation, "estimate_jointly", _estimated_once(expectation.estimate_jointly))
    slopes = jsbsim_run._answered
    patch.setattr(jsbsim_run, "_answered", lambda *asked: _made_once(asked, partial(slopes, *asked)))
    patch.setattr(joint_estimate, "fit_jointly", partial(_fitted_once, joint_estimate.fit_jointly))


def _fitted_once(
    fit_jointly: Callable[..., Any], maneuvers: Sequence[Maneuver], aircraft: Aircraft, _near: object = None
) -> Any:
    """What a campaign asks of a joint fit from the data alone: whether it tells the lag, and its estimate."""
    asked = (tuple(maneuvers), aircraft)
    fit = cache(lambda: fit_jointly(*asked))
    told = _made_once(("lag", asked), lambda: getattr(fit(), "tells_lag", fit()))
    if isinstance(told, NoEstimate):
        return told
    return SimpleNamespace(
        tells_lag=told,
        estimate=lambda: _made_once(("estimate", asked), lambda: fit().estimate()),
        fitted=SimpleNamespace(one_hill=False),
    )


def _estimated_once(function: Callable[..., Result]) -> Callable[..., Result]:
    """The function of manoeuvres and an aircraft, whose result is kept by every sample and number of both."""

    def recalled(*asked: Any) -> Result:
        search = asked[-1] if isinstance(asked[-1], JointSearch) or asked[-1] is None else None
        *axis, flown, aircraft = asked if search is None and asked[-1] is not None else asked[:-1]
        if search is not None:
            return function(*axis, flown, aircraft, search)
        key = tuple(flown) if isinstance(flown, Sequence) else flown
        return _made_once((function.__qualname__, key, aircraft), lambda: function(*axis, flown, aircraft))

    return recalled


def _made_once(asked: object, make: Callable[[], Result]) -> Result:
    """A copy of what another test made when it asked the same, or else what is made now."""
    written = BytesIO()
    pickler = pickle.Pickler(written)
    pickler.fast = True  # equal contents are equal bytes, whichever of their parts are one object
    pickler.dump(asked)
    SHARED.mkdir(exist_ok=True)
    with (SHARED / f"{sha256(written.getbuffer()).hexdigest()}.made").open("a+b", buffering=0) as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.seek(0)
        known = file.read()
        result: Result = pickle.loads(known) if known else make()
        if not known:
            kept, room = pickle.dumps(result), 0
            with suppress(OSError):  # a test lets no file grow
                room = file.write(kept)
            if room < len(kept):
                file.truncate(0)
    return result


def _deciding(argument: Any) -> Any:
    """What of an argument decides: values, and the settings of a campaign that is yet to be made."""
    if isinstance(argument, partial):
        return argument.args, argument.keywords
    if isinstance(argument, LogSeries) or callable(argument):
        return None
    return tuple(argument) if isinstance(argument, list) else argument
