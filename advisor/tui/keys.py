"""Every action of the screens with its key. Footers, help and settings read this single table."""

from textual.binding import Binding, BindingType


def _key(key: str, action: str, description: str, *, id: str, show: bool = False) -> Binding:
    return Binding(key, action, description, id=id, show=show)


# In the order of importance: a narrow footer leaves out the last ones.
EVERYWHERE: list[BindingType] = [
    _key("p", "face('pilot')", "Pilot", id="pilot", show=True),
    _key("e", "face('engineer')", "Engineer", id="engineer", show=True),
    _key("question_mark", "explain", "Help", id="help", show=True),
    _key("q", "leave", "Quit", id="quit", show=True),
    _key("ctrl+p", "command_palette", "More", id="commands", show=True),
]

REPLAY: list[BindingType] = [
    _key("space", "pause", "Pause", id="pause", show=True),
    _key("j", "jump", "Jump", id="jump", show=True),
    _key("plus,equals_sign", "faster", "Faster", id="faster", show=True),
    _key("minus", "slower", "Slower", id="slower", show=True),
    _key("full_stop", "step", "Step", id="step", show=True),
    _key("left_curly_bracket", "seek_by(-10)", "10 s back", id="back"),
    _key("right_curly_bracket", "seek_by(10)", "10 s on", id="ahead"),
    _key("right_square_bracket", "jump_by(1)", "Next manoeuvre", id="next_maneuver"),
    _key("left_square_bracket", "jump_by(-1)", "Previous manoeuvre", id="previous_maneuver"),
]

SELDOM: list[BindingType] = [
    _key("t", "next_theme", "Theme", id="theme", show=True),
    _key("m", "mark", "Mark", id="mark", show=True),
    _key("b", "begin_maneuver", "Begin manoeuvre", id="begin_maneuver", show=True),
    _key("f", "end_maneuver", "Finish manoeuvre", id="end_maneuver", show=True),
    _key("r", "other_axis", "Elevator, or roll and yaw", id="axis"),
    _key("k", "sound", "Bell and voice", id="sound"),
    _key("v", "follow_another", "Follow another vehicle", id="follow"),
    _key("a", "ask_for_outputs", "Ask for the elevator's output", id="outputs"),
    _key("g", "take_guess", "Take the guessed output", id="guess"),
]

PANES = (
    ("1", "manoeuvres"),
    ("2", "verdict"),
    ("3", "parameters"),
    ("4", "fit"),
    ("5", "live"),
    ("6", "criterion"),
    ("7", "channels and link"),
    ("8", "log"),
    ("9", "residuals"),
    ("0", "correlation"),
    ("h", "history"),
    ("u", "flying qualities"),
    ("i", "whole flight"),
    ("d", "gap to the simulator"),
)
"""Key and name of each pane, in the order of their numbers."""

ENGINEER: list[BindingType] = [
    _key("x", "exclude", "Exclude", id="exclude", show=True),
    _key("n", "note", "Note", id="note", show=True),
    _key("c", "copy", "Copy the pane", id="copy"),
    _key("s", "save", "Save the pane", id="save"),
    _key("o", "next_output", "Next output", id="next_output"),
    _key("l", "lay_over", "Lay a manoeuvre or a channel over", id="lay_over"),
    *(_key(key, f"choose({k})", f"Pane: {name}", id=f"pane_{k}") for k, (key, name) in enumerate(PANES, 1)),
]

FIT: list[BindingType] = [
    _key("left", "cursor(-1)", "Cursor to the left", id="cursor_left"),
    _key("right", "cursor(1)", "Cursor to the right", id="cursor_right"),
    _key("shift+left", "cursor(-1, True)", "One sample to the left", id="sample_left"),
    _key("shift+right", "cursor(1, True)", "One sample to the right", id="sample_right"),
    _key("up,z", "zoom(1)", "Zoom in", id="zoom_in"),
    _key("down,Z", "zoom(-1)", "Zoom out", id="zoom_out"),
    _key("less_than_sign", "pan(-1)", "Earlier", id="pan_left"),
    _key("greater_than_sign", "pan(1)", "Later", id="pan_right"),
    _key("w", "whole", "Whole record", id="whole"),
]
"""Keys that work while the fit pane has the focus."""

ACTIONS = frozenset(
    binding.id
    for binding in (*EVERYWHERE, *REPLAY, *SELDOM, *ENGINEER, *FIT)
    if isinstance(binding, Binding) and binding.id is not None
)
"""Names of all actions, by which settings may rebind them."""
