"""One flight, exported once in every format."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis import whole_flights
from advisor.analysis.whole_flights import WholeFlights
from advisor.exports.flights.formats import WRITERS, staged, write_formats
from advisor.exports.flights.reading import dataset
from advisor.exports.flights.table import Dataset
from advisor.report.document import analysis_document
from tests.flights import FOUR, recorded
from tests.recorded import use_recorded


@dataclass(frozen=True)
class Exported:
    log: Path
    folder: Path
    flights: WholeFlights
    data: Dataset
    document: dict[str, Any]
    """As ``advisor analyze --json`` prints."""


@pytest.fixture(scope="package")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Exported:
    log, folder = recorded("uav", 1.0, maneuvers=FOUR), tmp_path_factory.mktemp("export")
    with pytest.MonkeyPatch.context() as patch:
        use_recorded(patch)
        flights = whole_flights.read_whole([log], Aircraft(), axis="both")
    data = dataset(flights)
    with staged(folder) as stage:
        write_formats(data, stage, tuple(WRITERS))
    document = json.loads(json.dumps(analysis_document(flights.state, [str(log)], Aircraft())))
    return Exported(log, folder, flights, data, document)
