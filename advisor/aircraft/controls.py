"""Control surfaces of the aircraft file: outputs, calibration, servo."""

from dataclasses import dataclass
from typing import Annotated, Literal

from advisor.aircraft.key import Key

Pairs = tuple[tuple[float, float], ...]
"""A calibration: pairs (PWM in us, deflection in deg), with linear interpolation between pairs."""


@dataclass(frozen=True)
class ElevatorOutput:
    """One of several servo outputs that make the elevator's deflection."""

    output: Annotated[int, Key("Servo output 1..32.")]
    calibration: Annotated[Pairs | None, Key(
        "Pairs (PWM in us, deflection in deg, positive where the nose goes down). None: "
        "SERVOn_MIN/TRIM/MAX.",
    )] = None  # fmt: skip
    weight: Annotated[float, Key(
        "Share of the pitch effect per degree of deflection, relative to the other outputs.",
    )] = 1.0  # fmt: skip


@dataclass(frozen=True)
class Elevator:
    """Outputs, calibration and servo, which turn the elevator command into a deflection."""

    output: Annotated[int | Literal["auto"], Key(
        "Servo output 1..32. ``auto``: the outputs whose SERVOn_FUNCTION is elevator (19), elevon or "
        "V-tail.",
        example="auto",
        question="Servo output of the elevator: a number, several (1 2), or auto",
        answer="auto",
        cost="The elevator is found by the autopilot's parameters; without them a log or link is refused.",
        mend="write the number of the servo output",
    )] = "auto"  # fmt: skip
    calibration: Annotated[Pairs | None, Key(
        "Pairs (PWM in us, deflection in deg, trailing edge down positive), with linear interpolation. "
        "None: SERVOn_MIN/TRIM/MAX and ±25 deg.",
        example="[[1100, -25.0], [1500, 0.0], [1900, 25.0]]",
        question=(
            "Measured deflections of output {}, PWM:deg, trailing edge down positive (1100:-25 1500:0 "
            "1900:25)"
        ),
        cost="The servo's end points count as 25 deg, so Z_δe and M_δe have an assumed scale.",
        mend="measure the deflection at three pulse widths",
    )] = None  # fmt: skip
    outputs: tuple[ElevatorOutput, ...] = ()
    """All servo outputs that make the deflection. The key ``outputs`` replaces ``output`` and
    ``calibration``."""
    lag_s: Annotated[float | None, Key(
        "First-order lag of the servo, s. None: unknown, and every result says so.",
        example="0.05",
        question="First-order lag of the elevator's servo, s",
        cost=(
            "The lag is estimated with the derivatives. Intervals are wider, and M_α and M_δe are too "
            "small if a flight does not determine the lag."
        ),
        mend="film a step of the servo on the ground; the lag is the time to 63 % of the step",
        within=(0.0, 2.0),
    )] = None  # fmt: skip
    delay_s: Annotated[float | None, Key(
        "Delay between command and servo, s. None: unknown.",
        example="0.02",
        question="Delay from the logged command to the servo's first movement, s",
        cost="The delay counts as zero; a real delay biases M_α and M_q.",
        mend="film a step of the servo on the ground; the delay ends when the arm begins to move",
        within=(0.0, 2.0),
    )] = None  # fmt: skip

    @property
    def is_calibrated(self) -> bool:
        """Whether the file gives a calibration for every output of the elevator."""
        return self.calibration is not None or any(output.calibration for output in self.outputs)

    @property
    def ends_deg(self) -> tuple[float, float] | None:
        """Lowest and highest deflection of the calibration, deg. None without a calibration."""
        calibrations = [(output.weight, output.calibration) for output in self.outputs if output.calibration]
        if self.calibration:
            calibrations = [(1.0, self.calibration)]
        if not calibrations:
            return None
        total = sum(weight for weight, _ in calibrations)
        low = sum(weight * min(deg for _, deg in pairs) for weight, pairs in calibrations)
        high = sum(weight * max(deg for _, deg in pairs) for weight, pairs in calibrations)
        return low / total, high / total


@dataclass(frozen=True)
class SideControl:
    """Outputs, calibration and servo of the aileron or of the rudder."""

    output: Annotated[int | Literal["auto"], Key(
        "Servo output 1..32. ``auto``: all outputs whose SERVOn_FUNCTION is the control's (4 aileron, 21 "
        "rudder), with elevons, flaperons and V-tails.",
        example="auto",
        cost="The autopilot's parameters must name the output; without them roll and yaw are not analyzed.",
        mend="write the number of the servo output",
    )] = "auto"  # fmt: skip
    calibration: Annotated[Pairs | None, Key(
        "Pairs (PWM in us, deflection in deg), with linear interpolation. A positive aileron rolls to the "
        "left, a positive rudder yaws to the left. None: SERVOn_MIN/TRIM/MAX and ±25 deg.",
        example="[[1100, -25.0], [1500, 0.0], [1900, 25.0]]",
        cost="The servo's end points count as 25 deg, so Y, L and N by this control have an assumed scale.",
        mend="measure the deflection at three pulse widths",
    )] = None  # fmt: skip
    lag_s: Annotated[float | None, Key(
        "First-order lag of the servo, s. None: unknown.",
        example="0.05",
        cost="The lag is estimated with the derivatives: L_p and the control's moments are less certain.",
        mend="film a step of the servo on the ground; the lag is the time to 63 % of the step",
        within=(0.0, 2.0),
    )] = None  # fmt: skip
    delay_s: Annotated[float | None, Key(
        "Delay between command and servo, s. None: unknown.",
        example="0.02",
        within=(0.0, 2.0),
    )] = None  # fmt: skip

    @property
    def ends_deg(self) -> tuple[float, float] | None:
        """Lowest and highest deflection of the calibration, deg. None without a calibration."""
        if self.calibration is None:
            return None
        angles = [deg for _, deg in self.calibration]
        return min(angles), max(angles)
