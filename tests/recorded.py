"""Analyses of logs, made once a test run, whichever of its processes asks first.

Faces and exports are tested on what an analysis says. The estimator is the subject of other tests.
"""

import fcntl
import pickle
from collections.abc import Callable
from dataclasses import replace
from functools import partial, wraps
from hashlib import sha256
from inspect import signature
from typing import Any, TypeVar, cast

import pytest

from advisor.analysis import gap, side_gap, whole_flights
from advisor.analysis.log_series import LogSeries
from advisor.analysis.whole_flights import WholeFlights
from advisor.cli import analyze, page_content
from tests.flights import SHARED

Result = TypeVar("Result")


def use_recorded(patch: pytest.MonkeyPatch) -> None:
    """Let commands read the analysis of a log that another test of this run has analysed already."""
    whole, compared = _once(whole_flights.read_whole), _once(gap.compare_logs)
    for module in (whole_flights, page_content, side_gap):
        patch.setattr(module, "read_whole", whole)
    patch.setattr(gap, "compare_logs", compared)
    patch.setattr(analyze, "_analyze", _once(analyze._analyze))


def _once(function: Callable[..., Result]) -> Callable[..., Result]:
    """The function, whose result is kept by its arguments and by the content of its logs."""

    @wraps(function)
    def recalled(*arguments: Any, **settings: Any) -> Result:
        bound = signature(function).bind(*arguments, **settings)
        bound.apply_defaults()
        asked = {name: _deciding(value) for name, value in bound.arguments.items()}
        given = asked.pop("logs", None) or bound.arguments["series"].logs
        if not all(log.exists() for log in given):
            return function(*arguments, **settings)  # which says so
        read = [(log.name, log.read_bytes()) for log in given]
        by_hand = LogSeries(given).read_by_hand()
        key = sha256(pickle.dumps((function.__qualname__, asked, read, by_hand))).hexdigest()
        SHARED.mkdir(exist_ok=True)
        with (SHARED / f"{key}.analysis").open("a+b") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            file.seek(0)
            known = file.read()
            result: Any = pickle.loads(known) if known else function(*arguments, **settings)
            if not known:
                file.write(pickle.dumps(result))
        # Copies of one log in several folders have one analysis.
        if isinstance(result, WholeFlights):
            result = replace(result, logs=tuple(LogSeries(given).logs))
        return cast("Result", result)

    return recalled


def _deciding(argument: Any) -> Any:
    """What of an argument decides: values, and the settings of a campaign that is yet to be made."""
    if isinstance(argument, partial):
        return argument.args, argument.keywords
    if isinstance(argument, LogSeries) or callable(argument):
        return None
    return tuple(argument) if isinstance(argument, list) else argument
