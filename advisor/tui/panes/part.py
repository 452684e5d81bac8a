"""Parts of a screen."""

from abc import abstractmethod
from typing import ClassVar

from advisor.session.view import View


class Part:
    """Any widget that is shown each new `View`."""

    EITHER_AXIS: ClassVar[bool] = False
    """Whether the part can show roll and yaw. Other parts always show the elevator's axis."""

    @property
    def wants_showing(self) -> bool:
        """Whether the part is visible, so that painting is no waste of time."""
        return True

    @abstractmethod
    def show(self, view: View) -> None:
        """Update to a new moment. The update is cheap where nothing of the part's own changed."""
