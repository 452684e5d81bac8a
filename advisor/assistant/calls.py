"""Commands of the advisor for an assistant: each runs in a separate process, for a limited time."""

import json
from collections.abc import Sequence
from subprocess import DEVNULL
from typing import Any

from anyio import CapacityLimiter, fail_after, run_process

from advisor.assistant.folders import RefusedError
from advisor.process.children import python_module


class Calls:
    """Runs the advisor's commands, one at a time.

    Parameters
    ----------
    limit_s
        Time after which a command is ended, s.
    """

    def __init__(self, limit_s: float) -> None:
        self._limit_s = limit_s
        self._one = CapacityLimiter(1)

    async def document(self, arguments: Sequence[str]) -> dict[str, Any]:
        """Return the document that a command prints with ``--json``, for an unusable log too.

        Raises
        ------
        RefusedError
            The command fails, takes too long, or prints too much.
        """
        code, printed, said = await self._run([*arguments, "--json"])
        if not printed:
            raise RefusedError(said or f"advisor {arguments[0]} ended with exit code {code}.")
        document: dict[str, Any] = json.loads(printed)
        return document

    async def done(self, arguments: Sequence[str]) -> None:
        """Run a command that writes a file.

        Raises
        ------
        RefusedError
            The advisor's command fails or takes too long.
        """
        code, _, said = await self._run(arguments)
        if code:
            raise RefusedError(said or f"advisor {arguments[0]} ended with exit code {code}.")

    async def _run(self, arguments: Sequence[str]) -> tuple[int, bytes, str]:
        """Return exit code, standard output and the last line on standard error of a command."""
        words = [*python_module("advisor"), *arguments]
        try:
            async with self._one:
                with fail_after(self._limit_s):
                    done = await run_process(words, stdin=DEVNULL, check=False)
        except TimeoutError:
            limit = f"{self._limit_s:.0f} s"
            raise RefusedError(f"advisor {arguments[0]} was ended after {limit}, the limit here.") from None
        # Progress and warnings come first, the sentence on the failure last.
        said = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        return done.returncode, done.stdout, said
