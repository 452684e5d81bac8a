"""Hooks of the documentation site: pages that the code makes, and equations as MathML.

MkDocs calls the functions by their names. ``mkdocs.yml`` names this file.
"""

import html
import re
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from benchmarks.pages.fragments import filled
from benchmarks.pages.generated import BUILT_SAMPLES, PAGES, SAMPLES, SECTIONS

_EQUATION = re.compile(r'<(div|span) class="arithmatex">(.*?)</\1>', re.DOTALL)
_ROLE = re.compile(r":(?:func|class|meth|attr|mod):(?=<code>)")
"""Sphinx's word before a name in a docstring, as in ``:func:`read```."""
_NUMBER = re.compile(r"\\tag\{(.*?)\}")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """List what a folder of ``SECTIONS`` holds: decision records, pages for developers."""
    docs = Path(config.docs_dir)
    for section, folder in SECTIONS.items():
        found = sorted(path.relative_to(docs).as_posix() for path in (docs / folder).glob("*.md"))
        if found:
            config.nav.append({section: found})
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that the code makes."""
    for uri, make in PAGES.items():
        files.append(File.generated(config, uri, content=make()))
    for name in SAMPLES:
        files.append(File.generated(config, f"samples/{name}", abs_src_path=str(sample(name))))
    return files


def sample(name: str) -> Path:
    """Return the place of a sample page.

    Raises
    ------
    PluginError
        The sample is not written yet.
    """
    place = BUILT_SAMPLES / name
    if not place.is_file():
        raise PluginError(f"{place} is missing: run `make site`, which writes the sample pages first.")
    return place


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Put tables of results where a page asks for them."""
    return filled(markdown)


def on_page_content(content: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Write equations as MathML, which browsers show without a script, and names without their roles."""
    plain = _ROLE.sub("", content)
    return _EQUATION.sub(lambda found: _mathml(found[2], found[1] == "div"), plain)


def _mathml(source: str, is_block: bool) -> str:
    """An equation; a block has its number, which LaTeX calls its tag, at the right."""
    latex = html.unescape(source).strip()[2:-2].strip()
    if not is_block:
        return convert(latex, display="inline")
    number = _NUMBER.search(latex)
    shown = convert(_NUMBER.sub("", latex), display="block")
    label = f'<span class="number">({number[1]})</span>' if number else ""
    return f'<div class="equation">{shown}{label}</div>'
