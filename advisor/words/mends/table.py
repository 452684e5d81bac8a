"""Table with named columns (``.csv``, ``.mat``): columns, and the rate at which the table was written."""

from collections.abc import Sequence

from advisor.words.mends.mends import GOOD_HZ, Mends

_COLUMNS = {
    "ATTITUDE": "q, p, r, theta",
    "RAW_IMU": "a_x, a_y, a_z",
    "HIGHRES_IMU": "a_x, a_y, a_z",
    "SERVO_OUTPUT_RAW": "elevator, aileron, rudder",
    "AOA_SSA": "alpha, beta",
    "NAMED_VALUE_FLOAT": "alpha, beta",
    "VFR_HUD": "airspeed, height",
}


class Table(Mends):
    """Columns of a table."""

    names = _COLUMNS

    def faster(self, message: str) -> str:
        """Return the rate of the table's rows."""
        return f"write the table with {GOOD_HZ} rows a second, for {self.called(message)}"

    def present(self, messages: Sequence[str]) -> str:
        """Return the keys of the aircraft file that name the table's columns."""
        named = ", ".join(dict.fromkeys(self.called(message) for message in messages))
        return f"name the columns in the aircraft file (columns: {named})"
