"""Outcomes for programs: the ``advisor.expect/1`` document, and JUnit XML for continuous integration."""

from collections.abc import Sequence
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from advisor.expectations.check import Outcome
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem

SCHEMA = "advisor.expect/1"


def expect_document(
    log: str, file: str, outcomes: Sequence[Outcome], problems: Sequence[Problem] = ()
) -> dict[str, Any]:
    """Return the document of ``advisor expect --json``; an unusable log has problems and no outcomes."""
    return {
        "schema": SCHEMA,
        "usable": not problems,
        "problems": plain(problems),
        "log": log,
        "file": file,
        "holds": None if problems else all(outcome.holds for outcome in outcomes),
        "expectations": [picked(outcome, "name asked found holds") for outcome in outcomes],
    }


def junit(log: str, file: str, outcomes: Sequence[Outcome], problems: Sequence[Problem] = ()) -> bytes:
    """Return the report as UTF-8 XML: one test case for each outcome, and one error for an unusable log.

    Parameters
    ----------
    log, file
        Names of the log and of the expectations file.
    problems
        Reasons why the log cannot be used; then there are no outcomes.
    """
    failures = sum(not outcome.holds for outcome in outcomes)
    tests = len(outcomes) + bool(problems)
    counts: dict[str, str] = {
        "tests": str(tests),
        "failures": str(failures),
        "errors": str(int(bool(problems))),
    }
    root = Element("testsuites", {"name": "advisor expect", **counts})
    suite = SubElement(root, "testsuite", {"name": log, **counts})
    for outcome in outcomes:
        case = SubElement(suite, "testcase", classname=file, name=outcome.name)
        said = f"asked: {outcome.asked}; found: {outcome.found}"
        if outcome.holds:
            SubElement(case, "system-out").text = said
        else:
            SubElement(case, "failure", message=said, type="expectation").text = said
    if problems:
        case = SubElement(suite, "testcase", classname=file, name="log")
        said = "\n".join(map(str, problems))
        SubElement(case, "error", message=said, type=problems[0].code).text = said
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'.encode()
