"""Outcomes as JUnit XML, the format of test reports that continuous integration shows."""

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from advisor.expectations.check import Outcome
from advisor.words.problems import Problem


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
    for one in outcomes:
        case = SubElement(suite, "testcase", classname=file, name=one.name)
        said = f"asked: {one.asked}; found: {one.found}"
        if one.holds:
            SubElement(case, "system-out").text = said
        else:
            SubElement(case, "failure", message=said, type="expectation").text = said
    if problems:
        case = SubElement(suite, "testcase", classname=file, name="log")
        said = "\n".join(map(str, problems))
        SubElement(case, "error", message=said, type=problems[0].code).text = said
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'.encode()
