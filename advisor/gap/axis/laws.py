"""Laws of an axis without a name: surfaces that stop, stick or ring, and nonlinear curves.

A curve is a disturbance of one block. The curve consists of x·|x| and x³, where x is a deflection, a state or
a reading. The curve is symmetric to the left and to the right.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.axis.effects import AxisEffect, block_of, changes_of
from advisor.gap.axis.fit import Fit
from advisor.gap.axis.models import Case
from advisor.gap.inference.sizes import BENT, of_range
from advisor.gap.kit.effect import Variant
from advisor.gap.uncatalogued.candidate_laws import RINGING, STOPS, SURFACE_STOP, sticking, stops
from advisor.gap.verdict.missing_law import Lacking
from advisor.model.axis import Axis, Curve
from advisor.model.axis_response import respond_axis
from advisor.oem.alpha_use import FEWEST_SAMPLES
from advisor.oem.axis.disturbance import STEP_S, answered, courses_of
from advisor.process.arrays import FloatArray

_CURVE = Variant("curve", "", ("square", "cube"), ((0.0, 0.0),), (1.0, 1.0), ((-np.inf, np.inf),) * 2, 0.0)
_LAG_AND_DAMPING = replace(
    RINGING, names=("lag_s", "damping"), entries=("lag_s", "lag_damping"), apply_with=None,
    starts=tuple((2.0 * damping / omega, damping) for omega, damping in RINGING.starts),
    steps=(5e-4, 0.01), bounds=((0.0, 0.25), RINGING.bounds[1]),
)  # fmt: skip
"""Second-order servo: parameters of lag and damping, and their entries in the simulator."""


def axis_laws(case: Case, fit: Fit) -> Iterator[AxisEffect]:
    """Yield every law without a name that the records of a flight can show."""
    axis, problem = case.axis, case.flown.problem
    for of in filter(problem.flies, axis.inputs):
        moved = np.concatenate(
            [r.inputs[of].y - r.inputs[of].y[0] for r in problem.records if of in r.inputs]
        )
        most = max(float(np.max(np.abs(moved))), 1e-9)
        for law in (*stops(SURFACE_STOP, of, STOPS, np.zeros(1), moved), sticking(most), _LAG_AND_DAMPING):
            law = replace(law, block=of)
            places = tuple((of, entry) for entry in law.entries or law.names)
            yield AxisEffect(
                of, law, places, of_range(law), {law.effect: f"{of} {law.effect}"}, of not in axis.blocks
            )
    yield from (law for law in changes_of(case.flown) if not axis.changes[law.kind].has_name)
    if axis.curves:
        yield from curves_of(case, fit, (curve for curve in axis.curves if not curve.has_name))
        return
    motions = [_motion(fit, m) for m in range(len(case.flown))]
    sizes = case.prior_of(1.0, ()).precision ** -0.5
    slopes = {(term.state, term.factor): x for term, x in zip(axis.shared, sizes, strict=True)}
    for block in (*filter(problem.flies, axis.inputs), *(b for b in axis.sensors if b in motions[0])):
        yield from _curves(case, fit, motions, block, {block: 1.0})
    for block, state in axis.equations.items():
        yield from _curves(case, fit, motions, block, {of: slopes[state, of] for of in axis.letters.values()})


def curves_of(case: Case, fit: Fit, curves: Iterable[Curve]) -> Iterator[AxisEffect]:
    """Yield those of the axis' nonlinear terms that the records can show, along the motion of a fit."""
    axis, names = case.axis, case.axis.names.shared
    motions = [_from_trim(_motion(fit, m)) for m in range(len(case.flown))]
    most = {
        of: max(float(np.max(np.abs(motion[of]))) for motion in motions) + 1e-12
        for of in motions[0]
        if of != "t" and all(of in motion for motion in motions)
    }
    sizes = dict(zip(names, (case.prior_of(1.0, ()).precision ** -0.5).tolist(), strict=True))
    for curve in curves:
        if not (curve.block in axis.equations or curve.block in most):
            continue
        try:
            forms = [np.column_stack(curve.forms(motion, sizes)) for motion in motions]
        except KeyError:  # the flight lacks a reading
            continue
        linear = fit.linear(case.flown)
        parts = [
            answered(linear, m, curve.block, motion["t"], form)
            for m, (motion, form) in enumerate(zip(motions, forms, strict=True))
        ]
        std = tuple(curve.std(sizes, most))
        variant = replace(
            _CURVE, effect=curve.effect, block=curve.block, names=curve.names, starts=((0.0,) * len(std),),
            steps=tuple(0.1 * each for each in std), bounds=((-np.inf, np.inf),) * len(std),
            fixed=curve.fixed,
        )  # fmt: skip
        places = tuple((f"{curve.effect}.{axis.curves.index(curve)}", name) for name in curve.names)
        yield AxisEffect(curve.block, variant, places, std, columns=np.vstack(parts))


def along(case: Case, effect: AxisEffect, fit: Fit) -> AxisEffect:
    """Return an effect whose nonlinear terms follow the motion of a fit that contains the effect."""
    variant = effect.variant
    curves = (c for c in case.axis.curves if (c.effect, c.fixed) == (variant.effect, variant.fixed))
    return next((replace(effect, columns=e.columns) for e in curves_of(case, fit, curves)), effect)


def _from_trim(motion: Mapping[str, FloatArray]) -> Mapping[str, FloatArray]:
    """Return the motion relative to its first values."""
    return {of: y if of == "t" else y - np.median(y[:FEWEST_SAMPLES]) for of, y in motion.items()}


def lacking(case: Case, fit: Fit, block: str) -> Iterator[Lacking]:
    """Yield what each manoeuvre shows of a law in an equation, beyond a fit."""
    linear = fit.linear(case.flown)
    for m, course in enumerate(courses_of(linear, block)):
        rows, motion = fit.assembly.blocks[m], _motion(fit, m)
        moved = {
            name: np.interp(course.knots, motion["t"], motion[of])
            for of, name in _formula_names(case.axis).items()
        }
        left = linear.unabsorbed(m, fit.residual[rows, None])
        columns = (fit.weight[rows, None] * x for x in (course.columns, fit.columns[rows], left))
        responses, shared, residual = columns
        yield Lacking({**moved, "t": course.knots}, responses, shared, residual[:, 0])


def _formula_names(axis: Axis) -> Mapping[str, str]:
    """Return the name in a formula of each quantity on which a law may depend."""
    return {state: state for state in axis.letters.values()} | {of: n for n, of in axis.controls.items()}


def _curves(
    case: Case, fit: Fit, motions: Sequence[Mapping[str, FloatArray]], block: str, slopes: Mapping[str, float]
) -> Iterator[AxisEffect]:
    """Yield the nonlinear curves of a block, from the linear terms ``slopes``."""
    most = {of: max(float(np.max(np.abs(motion[of]))) for motion in motions) + 1e-12 for of in slopes}
    parts = []
    for m, motion in enumerate(motions):
        shares = [motion[of] / most[of] for of in slopes]
        forms = np.column_stack([form for x in shares for form in (x * np.abs(x), x**3)])
        parts.append(answered(fit.linear(case.flown), m, block, motion["t"], forms))
    columns = np.vstack(parts)
    for k, (of, slope) in enumerate(slopes.items()):
        name, std = f"{block} curve of {of}", BENT * slope * most[of]
        places = (name, "square"), (name, "cube")
        forms, at_control = columns[:, 2 * k : 2 * k + 2], block in case.axis.inputs
        yield AxisEffect(block, _CURVE, places, (std, std), {"curve": name}, at_control, forms)


def _motion(fit: Fit, m: int) -> Mapping[str, FloatArray]:
    """Return the states, deflections and readings of a manoeuvre at equal time steps, controls minus trim."""
    assembly, grid, axis = fit.assembly, fit.assembly.grid, fit.assembly.axis
    events = slice(grid.first[m], grid.first[m + 1])
    stamps = assembly.begin[m] + np.concatenate([[0.0], np.cumsum(grid.step_s[events][:-1])])
    own = assembly.t[assembly.owner == m]
    t = np.arange(np.min(own), np.max(own) + STEP_S, STEP_S)
    course = np.empty((len(grid.step_s), 2, len(grid.initial)))
    nothing = np.empty((0, fit.sensitivities.shape[1]))
    respond_axis(grid, fit.point.theta, fit.point.local, np.empty(len(assembly.z)), nothing, course)
    moves = dict(zip(axis.states, course[events, 0].T, strict=True))
    moves |= {f"{of}'": rate for of, rate in zip(axis.states, course[events, 1].T, strict=True)}
    moves |= {of: grid.inputs[events, k] - grid.inputs[events][0, k] for k, of in enumerate(axis.inputs)}
    moved = {name: np.interp(t, stamps, y) for name, y in moves.items()}
    for state in set(axis.states).intersection(assembly.rows[m]):
        rows = assembly.rows[m][state]
        bent = np.interp(t, assembly.t[rows], fit.added[rows])
        moved[state] += bent
        moved[f"{state}'"] += np.gradient(bent, t)
    for output, rows in assembly.rows[m].items():
        moved[block_of(axis, output)] = np.interp(t, assembly.t[rows], fit.fitted[rows])
    return {**moved, "t": t}
