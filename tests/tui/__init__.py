"""Tests of the screens. Their applications find no program that speaks."""

from advisor.tui import sound

sound._PROGRAMS = ()
