"""Questions on the terminal for a new aircraft file. The reader of aircraft files checks each answer."""

from typing import Any

import click

from advisor.aircraft.key import Key
from advisor.aircraft_file.lacks import KEYS
from advisor.aircraft_file.read import parse_aircraft
from advisor.words.problems import ConfigurationError


def ask() -> dict[str, Any]:
    """Ask for every key that a crew can know.

    Returns
    -------
    Path of the key to its value; a key that the user does not know is missing.

    Raises
    ------
    ConfigurationError
        The input ends before the last question.
    """
    click.echo(
        "Press Enter to accept the answer in brackets, or enter '-' to leave the key out.",
        err=True,
    )
    values: dict[str, Any] = {}
    for key in KEYS:
        has_vane = str(values.get("alpha.source", "")).startswith(("named_value:", "aoa_ssa"))
        if key.path == "alpha.vane_arm_m" and not has_vane:
            continue
        if key.path == "elevator.calibration":
            _ask_calibrations(key.question, values)
        elif key.question:
            _put(key, values)
    return values


def nested(values: dict[str, Any]) -> dict[str, Any]:
    """Return the values, given by dotted paths, as nested sections of the aircraft file."""
    content: dict[str, Any] = {}
    for path, value in values.items():
        *sections, name = path.split(".")
        section = content
        for part in sections:
            section = section.setdefault(part, {})
        section[name] = value
    return content


def _put(key: Key, values: dict[str, Any]) -> None:
    """Ask until an answer is valid."""
    while True:
        text = _answer(key.question, key.answer)
        if text == "-":
            return
        try:
            answer = _value(key, text)
            parse_aircraft(nested(values | answer), "This answer")
        except (ValueError, ConfigurationError) as error:
            click.echo(f"  {error}", err=True)
        else:
            values |= answer
            return


def _value(key: Key, text: str) -> dict[str, Any]:
    if key.hint is str:
        return {key.path: text}
    if key.path == "elevator.output":
        if text == "auto":
            return {key.path: text}
        numbers = [_whole(word) for word in text.replace(",", " ").split()]
        if len(numbers) == 1:
            return {key.path: numbers[0]}
        return {"elevator.outputs": [{"output": number} for number in numbers]}
    try:
        return {key.path: float(text)}
    except ValueError:
        raise ValueError(f"{text} is not a number: give a number, or - to leave this key out.") from None


def _whole(word: str) -> int:
    try:
        return int(word)
    except ValueError:
        raise ValueError(
            f"{word} is not an output: give one number, several numbers (1 2), or auto."
        ) from None


def _ask_calibrations(question: str, values: dict[str, Any]) -> None:
    """Ask for the calibration of each output; without one answer, leave all calibrations out."""
    several = values.get("elevator.outputs")
    if several is None:
        while (pairs := _pairs(question.format(values.get("elevator.output", "auto")))) is not None:
            if _taken({**values, "elevator.calibration": pairs}):
                values["elevator.calibration"] = pairs
                return
        return
    measured = []
    for output in several:
        while (pairs := _pairs(question.format(output["output"]))) is not None:
            trial = [{**output, "calibration": pairs}]
            if _taken({"elevator.outputs": trial}):
                measured += trial
                break
        if pairs is None:
            return
    values["elevator.outputs"] = measured


def _taken(values: dict[str, Any]) -> bool:
    try:
        parse_aircraft(nested(values), "This answer")
    except ConfigurationError as error:
        click.echo(f"  {error}", err=True)
        return False
    return True


def _pairs(question: str) -> list[list[float]] | None:
    """Ask for pairs of PWM and deflection; return None if none are measured."""
    while True:
        text = _answer(question, "-")
        if text == "-":
            return None
        try:
            pairs = [[float(number) for number in word.split(":")] for word in text.replace(",", " ").split()]
        except ValueError:
            pairs = []
        if pairs and all(len(pair) == 2 for pair in pairs):
            return sorted(pairs)
        click.echo("  Give pairs PWM:deg with a space between, e.g. 1100:-25 1500:0 1900:25.", err=True)


def _answer(question: str, default: str) -> str:
    try:
        text: str = click.prompt(question, default=default, err=True)
    except click.Abort as end:
        raise ConfigurationError(
            "The input ended before the last question, so nothing was written. Answer them on a terminal, "
            "or let a log answer: advisor aircraft new --from LOG."
        ) from end
    return text.strip()
