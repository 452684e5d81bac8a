"""PX4's own log before 2017 (``.px4log``): records and the parameters of sdlog2."""

from collections.abc import Sequence

from advisor.words.mends.mends import GOOD_HZ, Mends

_RECORDS = {
    "ATTITUDE": "ATT",
    "RAW_IMU": "IMU",
    "HIGHRES_IMU": "IMU",
    "SERVO_OUTPUT_RAW": "OUT0",
    "AOA_SSA": "AIRS",
    "VFR_HUD": "AIRS",
}


class Sdlog2(Mends):
    """Records of sdlog2."""

    names = _RECORDS

    def faster(self, message: str) -> str:
        """Return the rate setting, which all records of the log share."""
        return f"set SDLOG_RATE to {GOOD_HZ}, at which sdlog2 logs {self.called(message)}"

    def present(self, messages: Sequence[str]) -> str:
        """Return the setting that adds the given records."""
        named = ", ".join(dict.fromkeys(self.called(message) for message in messages))
        return f"set SDLOG_EXT to 1, so that sdlog2 logs {named}"
