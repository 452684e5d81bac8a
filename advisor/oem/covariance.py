"""Errors of an estimate: the Cramér-Rao bound, its correction for coloured residuals, and the weights of
records.

Near the optimum the estimate is linear in the noise, θ̂ - θ = Aᵀ·ν, where A is the influence matrix of the
measurements. White noise of covariance R gives AᵀRA, the Cramér-Rao bound. Residuals of real flights are
coloured. The covariance is then AᵀΓA, with the noise's autocovariance Γ from the residuals. The source is
Klein & Morelli, *Aircraft System Identification*, on output-error estimates with coloured residuals; the
noise model here is that of ``colour``.

Let Γ = L·Lᵀ be the autocovariance of the noise. Residuals and sensitivities times L⁻¹ belong to white noise
of unit variance. For white noise the weights are those of output error, 1/σ².
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from advisor.model.outputs import N_LOCAL, N_SHARED, OUTPUTS
from advisor.oem.arrow import arrow_step, inverse_of, normal_equations
from advisor.oem.colour import Colour, Stretch, find_colour, moved, powers, product
from advisor.oem.extra import Extra
from advisor.oem.rows import Laid
from advisor.oem.whitening import Whitening
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95

OPEN_SHARE = 0.01
"""Largest share of a resolved parameter in undetermined directions. Above this share the parameter counts as
unresolved."""
DIFFERENCE = 0.05
LEAST_FREEDOM = 3.0


@dataclass(frozen=True, slots=True)
class Influence:
    """Linear map from the measurements to the eight parameters."""

    rows: FloatArray
    """Shape (N, 8 + k): change of each parameter for a unit change of each measurement."""
    condition: float
    """Condition number of the eight parameters' information matrix, scaled to a unit diagonal."""
    unresolved: tuple[str, ...]
    """Parameters with a part in a direction that the data do not determine."""
    shared_inverse: FloatArray
    """Shape (f, 8 + k): rows of the inverse information for the f free shared parameters."""
    prior_rows: FloatArray
    """Shape (k, 8 + k): change of each parameter when a prior mean moves by the prior's standard
    deviation."""

    @property
    def prior_covariance(self) -> FloatArray:
        """Shape (8 + k, 8 + k): covariance from the errors of the priors."""
        return np.asarray(self.prior_rows.T @ self.prior_rows)

    def step(self, residual: FloatArray, extra: Extra | None) -> FloatArray:
        """Return the Gauss-Newton step of the parameters, shape (8 + k,), for ``residual`` (N,)."""
        pulled = 0.0 if extra is None else self.prior_rows.T @ extra.pull
        return np.asarray(self.rows.T @ residual + pulled)

    def first(self, parameters: int) -> "Influence":
        """Return the influence on the first ``parameters`` parameters only; the others stay free."""
        return replace(self, rows=self.rows[:, :parameters], prior_rows=self.prior_rows[:, :parameters])


@dataclass(frozen=True, slots=True)
class Coloured:
    """Noise model of a fit, with its uncertainty."""

    colours: Mapping[str, Colour]
    """Noise model of each output, by the output's name."""
    widening: FloatArray
    """Shape (8 + k,): factor on each standard deviation due to the uncertainty of the noise model."""


def influence(
    assembly: Laid,
    g: FloatArray,
    noise: FloatArray,
    extra: Extra | None = None,
    prior: FloatArray | None = None,
) -> Influence | None:
    """Return the influence of every measurement on the eight parameters; None on numerical overflow.

    Z_0 and M_0 are means over the manoeuvres.

    Parameters
    ----------
    extra : additional parameters, such as a servo's lag; the result then has their columns after the eight.
    prior : (7,) inverse prior variances of the shared parameters.
    """
    weight = 1.0 / noise[assembly.channel] ** 2
    names, split = assembly.names, len(assembly.names.shared)
    reported = len(names.reported)
    common, own = assembly.common, assembly.own
    shared_g = g[:, common] if extra is None else np.column_stack([g[:, common], extra.columns])
    places = [
        (j, int(np.searchsorted(own, split + i)))
        for j, (shared, i) in enumerate(names.places)
        if not shared and split + i in own
    ]
    parts = []
    projected = np.empty_like(shared_g)
    open_share = np.zeros(split + len(names.local))
    for rows in assembly.blocks:
        mine = g[rows][:, own]
        weighted = (mine * weight[rows, None]).T
        own_information = weighted @ mine
        if not np.all(np.isfinite(own_information)):
            return None
        inverse, left_open = inverse_of(own_information)
        open_share[own] = np.maximum(open_share[own], left_open)
        mix = inverse @ (weighted @ shared_g[rows])
        projected[rows] = shared_g[rows] - mine @ mix
        parts.append((rows, inverse, weighted, mix))
    weighted_shared = projected * weight[:, None]
    information = projected.T @ weighted_shared
    if prior is not None:
        information[: len(common), : len(common)] += np.diag(prior[common])
    weights = np.empty(0) if extra is None else extra.weight / extra.share
    information[len(common) :, len(common) :] += np.diag(weights**2)
    if not np.all(np.isfinite(information)):
        return None
    inverse, left_open = inverse_of(information)
    open_share[common] = left_open[: len(common)]
    columns = np.zeros((len(inverse), reported + len(inverse) - len(common)))
    columns[:, reported:] = inverse[:, len(common) :]
    position = {int(index): k for k, index in enumerate(common)}
    for j, (is_shared, index) in enumerate(names.places):
        if is_shared and index in position:
            columns[:, j] = inverse[:, position[index]]
    for j, at in places:
        columns[:, j] = -inverse @ np.mean([mix[at] for *_, mix in parts], axis=0)
    result: FloatArray = weighted_shared @ columns
    spread = weights if extra is None else weights / extra.share
    prior_rows: FloatArray = spread[:, None] * columns[len(common) :]
    for rows, own_inverse, weighted, _ in parts:
        for j, at in places:
            result[rows, j] += own_inverse[at] @ weighted / len(parts)
    wanted = result[:, :reported]
    from_priors = prior_rows[:, :reported]
    covariance = (wanted / weight[:, None]).T @ wanted + from_priors.T @ from_priors
    scale = np.sqrt(np.diag(covariance))
    if not np.all(np.isfinite(scale)):
        return None
    scale = np.where(scale > 0.0, scale, 1.0)
    correlation = covariance / np.outer(scale, scale)
    return Influence(
        rows=result,
        condition=float(np.linalg.cond(correlation)),
        unresolved=tuple(
            name
            for name, (is_shared, index) in zip(names.reported, names.places, strict=True)
            if open_share[index if is_shared else split + index] > OPEN_SHARE
        ),
        shared_inverse=columns[: len(common)],
        prior_rows=prior_rows,
    )


def cramer_rao(assembly: Laid, rows: FloatArray, noise: FloatArray) -> FloatArray:
    """Return the Cramér-Rao bound AᵀRA, shape (8 + k, 8 + k)."""
    return (rows * noise[assembly.channel, None] ** 2).T @ rows


def colours_of(assembly: Laid, residual: FloatArray, g: FloatArray) -> Mapping[str, Colour]:
    """Return the noise model of each output, pooled over the manoeuvres, by the output's name."""
    return {
        output: find_colour([Stretch(residual[s], g[s][:, assembly.free]) for s in stretches])
        for output, stretches in _stretches(assembly).items()
    }


def coloured(assembly: Laid, rows: FloatArray, noise: Coloured) -> FloatArray:
    """Return AᵀΓA, shape (8 + k, 8 + k), with each standard deviation widened."""
    total = np.zeros((rows.shape[1], rows.shape[1]))
    for output, stretches in _stretches(assembly).items():
        for s in stretches:
            total += product(rows[s], noise.colours[output])
    return np.asarray(total * np.outer(noise.widening, noise.widening))


def widening(assembly: Laid, rows: FloatArray, colours: Mapping[str, Colour]) -> FloatArray:
    """Return the factor on each standard deviation due to the noise model's uncertainty, shape (8 + k,).

    The noise model's uncertainty is carried to each variance (Satterthwaite's degrees of freedom). The
    deviation is enlarged by the ratio of Student's to Gauss's 97.5 % point. ±1.96 standard deviations then
    hold the truth in 95 % of cases.
    """
    variance, spread = np.zeros(rows.shape[1]), np.zeros(rows.shape[1])
    for output, stretches in _stretches(assembly).items():
        colour = colours[output]

        def part(colour: Colour, stretches: list[slice] = stretches) -> FloatArray:
            return np.asarray(np.sum([powers(rows[s], colour) for s in stretches], axis=0))

        own = part(colour)
        slopes = [own]
        for i in range(1, len(colour.uncertainty)):
            step = np.zeros(3)
            step[i] = DIFFERENCE
            slopes.append((part(moved(colour, step)) - part(moved(colour, -step))) / (2.0 * DIFFERENCE))
        variance += own
        spread += np.einsum("ij,ik,kj->j", slopes, colour.uncertainty, slopes)
    freedom = np.full(len(variance), 1e9)
    uncertain = spread > 0.0
    freedom[uncertain] = np.maximum(2.0 * variance[uncertain] ** 2 / spread[uncertain], LEAST_FREEDOM)
    return np.asarray(stdtrit(freedom, 0.975) / NORMAL_95, np.float64)


def _stretches(assembly: Laid) -> dict[str, list[slice]]:
    """Return the rows of each output in each manoeuvre that has it, by the output's name."""
    return {
        output: [named[output] for named in assembly.rows if output in named]
        for output in assembly.names.outputs
        if any(output in named for named in assembly.rows)
    }


UNIT = np.ones(len(OUTPUTS))


@dataclass(frozen=True, slots=True)
class Weighing:
    """Factor L⁻¹ for all measurements of a problem."""

    assembly: Laid
    by_maneuver: tuple[Mapping[str, Whitening], ...]
    """Whitening filter of each output, by the output's name, in one mapping per manoeuvre."""

    @classmethod
    def by(cls, colours: Mapping[str, Colour], assembly: Laid) -> "Weighing":
        """Return the weighing for a noise model, valid for any problem with these measurements."""

        def whitening(output: str, samples: int) -> Whitening:
            colour = colours[output]
            # An output that never moves has no residual and no influence; it keeps its unit.
            return Whitening.of(samples, colour.memory, colour.white_share, colour.variance or 1.0)

        return cls(
            assembly,
            tuple(
                {output: whitening(output, rows.stop - rows.start) for output, rows in named.items()}
                for named in assembly.rows
            ),
        )

    @property
    def volume(self) -> float:
        """Logarithm of the determinant of Γ."""
        each = (part for named in self.by_maneuver for part in named.values())
        return -2.0 * sum(float(np.sum(np.log(part.scale))) for part in each)

    def forward(self, rows: FloatArray) -> FloatArray:
        """Return L⁻¹·rows, shape (N, k)."""
        return self._each(Whitening.forward, rows)

    def backward(self, rows: FloatArray) -> FloatArray:
        """Return L⁻ᵀ·rows, shape (N, k)."""
        return self._each(Whitening.backward, rows)

    def influence(self, g: FloatArray, extra: Extra | None) -> Influence | None:
        """Return the influence of every measurement on the efficient estimate; None on numerical overflow."""
        seen = None if extra is None else extra.whitened(self.forward(extra.columns))
        weighed = influence(self.assembly, self.forward(g), UNIT, seen)
        return None if weighed is None else replace(weighed, rows=self.backward(weighed.rows))

    def misfit(self, residual: FloatArray, g: FloatArray) -> float:
        """Return the weighted sum of squares, minus the decrease by one last step of all parameters.

        The difference between two models of one record is twice the log likelihood ratio.
        """
        white = self.forward(residual[:, None])[:, 0]
        a = self.assembly
        information, gradient = normal_equations(
            a.maneuvers, white, self.forward(g), a.channel, a.owner, a.free, UNIT
        )
        *_, promise = arrow_step(information, gradient, a.free, 0.0, N_SHARED, N_LOCAL)
        return float(white @ white) - promise

    def _each(self, apply: Callable[[Whitening, FloatArray], FloatArray], rows: FloatArray) -> FloatArray:
        result = np.empty(rows.shape)
        for named, parts in zip(self.assembly.rows, self.by_maneuver, strict=True):
            for output, part in parts.items():
                result[named[output]] = apply(part, rows[named[output]])
        return result
