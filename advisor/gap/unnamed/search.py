"""What has no name, asked for in order: the first that is found is the answer."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.measure import file_model_of
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.quiet import quiet_rms
from advisor.gap.noise.stamps import stamp_power
from advisor.gap.records.floor import tolerance_of
from advisor.gap.search.air import Air, moving_air
from advisor.gap.search.stage import Stage
from advisor.gap.search.waterfall import reduced_to
from advisor.gap.unnamed.cross_axis import crossed_axes
from advisor.gap.unnamed.drift import drifting
from advisor.gap.unnamed.leftover import (
    Leftover,
    is_of_passing_air,
    is_the_gust,
    left_over,
    other_than_air,
)
from advisor.gap.unnamed.memory import remembering
from advisor.gap.unnamed.remainder import (
    bends_as_any,
    is_all_named,
    is_of_no_use,
    only_numbers,
    only_resemble,
    remainder,
)
from advisor.gap.unnamed.slosh import sloshing
from advisor.gap.unnamed.steps import stepping
from advisor.gap.unnamed.swing import swinging, swings_the_aircraft
from advisor.gap.unnamed.unnamed_air import unnamed_air
from advisor.gap.unnamed.unsteady import unsteady
from advisor.gap.unnamed.wander import wandering_attitude, wandering_sensor

_FAR_ABOVE = 2.0
"""A floor over white noise from which on it is no longer an instrument's, with whatever memory."""


@dataclass(frozen=True)
class Scene:
    """The model with everything that was named, and the air it was flown in."""

    problem: Problem
    stages: list[Stage]
    air: Air | None
    tolerance: FloatArray
    """Shape (channels,): the least error of an instrument that is told of."""
    floor: FloatArray
    """Shape (channels,): noise as it is where nothing was flown."""
    file_model: HeldOut | None
    bends_as_any: bool
    """What was named is no more than every airframe has."""

    @property
    def plain(self) -> Fitted:
        """The model without a name."""
        return self.stages[0].fitted

    @property
    def last(self) -> Fitted:
        """The model with all names."""
        return self.stages[-1].fitted

    def without_names(self) -> "Scene":
        """The plain model, and the air that it was flown in."""
        stages = reduced_to(self.problem, self.stages, [])
        floor = _floor(self.problem, stages[0], self.tolerance)
        air = moving_air(self.problem, stages[0].fitted)
        return replace(self, stages=stages, air=air, floor=floor)


def scene_of(problem: Problem, stages: list[Stage], air: Air | None) -> Scene:
    """Look at what the names leave, above the noise as it is where nothing was flown."""
    tolerance = tolerance_of(problem.flights)
    floor, file_model = _floor(problem, stages[-1], tolerance), file_model_of(problem, stages[0].fitted)
    as_any = bends_as_any(problem, stages, file_model, floor)
    return Scene(problem, stages, air, tolerance, floor, file_model, as_any)


def without_a_name(scene: Scene) -> tuple[Leftover | None, Scene]:
    """The first that is found, and the scene without names that turn out to be none."""
    found = next((found for ask in IN_ANY_AIR if (found := ask(scene)) is not None), None)
    if found is not None:
        return found, scene
    if scene.air is not None and (only_resemble(scene.stages) or scene.bends_as_any):
        scene = scene.without_names()
        found = _disturbance(scene)
    if found is None and scene.air is not None:
        found = unnamed_air(scene.air, scene.stages, scene.floor)
    if found is None and not (scene.air is not None and scene.air.gust):
        found = sloshing(scene.problem, scene.last)
    if found is None and scene.air is None:
        return _in_still_air(scene)
    return found, scene


def _in_still_air(scene: Scene) -> tuple[Leftover | None, Scene]:
    """What names leave of the gap; without any, an instrument that wanders, and noise that is none."""
    problem, stages, floor = scene.problem, scene.stages, scene.floor
    found = None if scene.bends_as_any else remainder(problem, stages, scene.file_model, floor)
    if found is not None:
        return found, scene
    needless = scene.bends_as_any or is_of_no_use(problem, stages, scene.file_model, floor)
    if needless or only_numbers(problem, stages, scene.file_model, floor):
        scene = replace(scene, stages=reduced_to(problem, stages, []))
    elif len(stages) == 1:
        found = wandering_sensor(problem, scene.last)
    return found or unsteady(problem, scene.last, floor), scene


def _disturbance(scene: Scene) -> Leftover | None:
    """What the last model leaves that is neither noise nor the air."""
    problem, air, last = scene.problem, scene.air, scene.last
    # The filter takes a swing for noise: as a line it is seen, and placed, better than by any other sign.
    swing = swinging(problem, scene.plain, last, scene.tolerance)
    swing = swing or swings_the_aircraft(problem, scene.plain, last)
    if swing is not None:
        return swing
    all_named = air is None and is_all_named(scene.stages, _of_instruments(scene))
    leftover = left_over(problem, scene.plain, last, scene.tolerance, air is not None, all_named)
    slight = None if leftover is None else scene.stages[-1].slight_in(leftover.block)
    if slight is not None:
        # A cause that is known, and below its physical minimum, leaves nothing without a name.
        last = slight.fitted
        leftover = left_over(problem, scene.plain, last, scene.tolerance, air is not None, all_named)
    if air is None:
        return leftover
    if air.gust and leftover is not None and is_the_gust(problem, last, leftover):
        return None
    if leftover is None or leftover.block == "air" or is_of_passing_air(problem, last, leftover):
        return other_than_air(problem, scene.plain, last)
    return leftover


IN_ANY_AIR: tuple[Callable[[Scene], Leftover | None], ...] = (
    lambda scene: drifting(scene.problem, scene.stages),
    lambda scene: remembering(scene.problem, scene.stages),
    lambda scene: stepping(scene.problem, scene.plain, scene.last),
    lambda scene: wandering_attitude(scene.problem, scene.last),
    lambda scene: crossed_axes(scene.problem, scene.last),
    _disturbance,
)
"""What is asked for in any air: signs of one thing each, and last an unknown disturbance."""


def _of_instruments(scene: Scene) -> FloatArray:
    """The floor, but the white noise where it is far above that: something goes on in quiet, too."""
    white, floor = scene.problem.instruments, scene.floor
    return floor if white is None else np.where(floor > _FAR_ABOVE * white, white, floor)


def _floor(problem: Problem, last: Stage, tolerance: FloatArray) -> FloatArray:
    """Shape (channels,): noise as it is where nothing was flown."""
    # Stamps that jitter are the instruments', too, but show only where something moves.
    measured = quiet_rms(problem, last.fitted) ** 2 + stamp_power(problem, last.fitted)
    return np.maximum(np.sqrt(np.minimum(measured, last.held_out.mean_square)), tolerance)
