"""Origin of the page: files with their hashes, versions, and the command that repeats the page."""

from advisor.report.page.blocks import Paragraph, Section, Verbatim
from advisor.report.page.content import Content
from advisor.report.table import Table


def provenance(content: Content) -> Section:
    """Return the section on hashes, versions and the command."""
    origin = content.origin
    return Section(
        "origin",
        "Where this comes from",
        (
            Table("files", "Input files.", ("file", "SHA-256"), tuple(origin.files.items())),
            Table("versions", "Versions.", ("program", "version"), tuple(origin.versions.items())),
            Paragraph("This command repeats the page:"),
            Verbatim(origin.command),
        ),
    )
