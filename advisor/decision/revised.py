"""Verdicts that later manoeuvres change: a sentence of its own for each, with the reason."""

from advisor.decision.verdict import ManeuverVerdict


def revision(before: ManeuverVerdict, after: ManeuverVerdict, newest: int) -> str:
    """Return a sentence about a verdict that changed; empty where the manoeuvre is judged as before.

    Parameters
    ----------
    before, after
        Verdict that the crew heard, and the present verdict on the same manoeuvre.
    newest
        Number of the newest manoeuvre, whose data changed the verdict.
    """
    if before.accepted == after.accepted:
        return ""
    if after.accepted:
        return f"refused before, accepted since manoeuvre {newest}: it no longer {_fault(before)}"
    return f"accepted before, refused since manoeuvre {newest}: {_objection(after)}"


def _objection(refused: ManeuverVerdict) -> str:
    return refused.reasons[0].text if refused.reasons else refused.sentence


def _fault(refused: ManeuverVerdict) -> str:
    """Return the former objection without its remedy, as a clause."""
    said = _objection(refused).partition("; ")[0]
    return said if said.startswith("contradicts") else f"counts against it that {said}"
