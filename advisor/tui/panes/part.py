"""What a screen is made of."""

from abc import abstractmethod

from advisor.tui.view import View


class Part:
    """Any widget that is shown a `View` whenever there is a new one."""

    @property
    def wants_showing(self) -> bool:
        """False while it is out of sight and would only waste time."""
        return True

    @abstractmethod
    def show(self, view: View) -> None:
        """Update to a new moment; cheap when nothing of the part's own changed."""
