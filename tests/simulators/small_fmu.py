"""Builds a small FMU of FMI 2 or FMI 3 from C source: compiler, model description, zip."""

import subprocess
import zipfile
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

HERE = Path(__file__).parent
HEADERS = Path(fmpy.__file__).parent / "c-code"
SIDE = ("aileron", "rudder", "p", "r", "bank", "beta", "a_y")
NAMES = ("delta_e", "force", "moment", "V", "h", "alpha_0", "theta_0", "alpha", "q", "theta", "n_z", *SIDE)
INPUTS, PARAMETERS = (*NAMES[:3], "aileron", "rudder"), NAMES[3:7]
STARTS = {"V": 30.0, "h": 500.0, "delta_e": -0.11}


def build(
    folder: Path,
    fmi: int,
    fault: int | None = None,
    platform: str | None = None,
    lag_s: float | None = None,
) -> Path:
    """Return an FMU in ``folder``; ``platform`` names another folder of binaries than this computer's."""
    flags = [*(["-DFMI3"] if fmi == 3 else []), *([] if fault is None else [f"-DFAULT={fault}"])]
    flags += [] if lag_s is None else [f"-DLAG={lag_s}"]
    file = folder / "short_period.fmu"
    place = platform or (fmpy.platform if fmi == 2 else fmpy.platform_tuple)
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", described(fmi))
        suffix = ".dylib" if "darwin" in place else fmpy.sharedLibraryExtension
        archive.writestr(f"binaries/{place}/ShortPeriod{suffix}", _library(fmi, *flags))
    return file


@cache
def _library(fmi: int, *flags: str) -> bytes:
    """The shared library that the C source makes with these flags, compiled once a process."""
    with TemporaryDirectory() as folder:
        library = Path(folder) / "library"
        source, rest = HERE / "short_period.c", Path(folder) / "rest.c"
        rest.write_text(_rest(fmi, source.read_text()))
        made = ["cc", "-shared", "-fPIC", "-O1", *flags, f"-I{HEADERS}", source, rest, "-o", library, "-lm"]
        subprocess.run(made, check=True)
        return library.read_bytes()


def described(fmi: int) -> str:
    variables = "".join(_variable(fmi, i, name) for i, name in enumerate(NAMES))
    if fmi == 2:
        head = 'fmiVersion="2.0" modelName="s" guid="{s}"'
        structure = '<Outputs><Unknown index="8"/></Outputs>'
    else:
        head = 'fmiVersion="3.0" modelName="s" instantiationToken="{s}"'
        structure = '<Output valueReference="7"/>'
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription {head}>'
        '<CoSimulation modelIdentifier="ShortPeriod"/>'
        '<DefaultExperiment startTime="0" stepSize="0.02"/>'
        f"<ModelVariables>{variables}</ModelVariables><ModelStructure>{structure}</ModelStructure>"
        "</fmiModelDescription>"
    )


def _rest(fmi: int, source: str) -> str:
    """Return the source of the standard's functions that the small FMU has no use for: each refuses."""
    kinds = (FMU2Slave, FMU2Model) if fmi == 2 else (FMU3Slave, FMU3Model)
    known = sorted({name for kind in kinds for name in dir(kind) if name.startswith(f"fmi{fmi}")})
    names = [name for name in known if f" {name}(" not in source]
    return "".join(f"int {name}(void) {{ return 3; }}\n" for name in names)


def _variable(fmi: int, i: int, name: str) -> str:
    causality = "input" if name in INPUTS else "parameter" if name in PARAMETERS else "output"
    kind = 'variability="fixed"' if name in PARAMETERS else 'variability="continuous"'
    start = "" if causality == "output" else f'start="{STARTS.get(name, 0.0)}"'
    common = f'name="{name}" valueReference="{i}" causality="{causality}" {kind}'
    if fmi == 2:
        return f"<ScalarVariable {common}><Real {start}/></ScalarVariable>"
    return f"<Float64 {common} {start}/>"
