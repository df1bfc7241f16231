"""tomcom's recordings and tables in pandas, and its program from Python.

    import tomcom

    trial = tomcom.read("sessions/2026-03-14-P07-1")
    trial.presses
    recordings = tomcom.simulate("sessions/default.toml", trials=20, out="pilot")
    tomcom.study("pilot").trials

Reading needs no program. Of every table the columns are the same in each recording, also where it has no rows.

pandas is imported when the first recording or table is read: `tomcom.agent` needs nothing but Python.
"""

from typing import TYPE_CHECKING, Any

from .program import ProgramFailed, Study, program, run, simulate, study

if TYPE_CHECKING:
    from .recording import Recording, read, recordings

__all__ = ["ProgramFailed", "Recording", "Study", "program", "read", "recordings", "run", "simulate", "study"]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import recording

    return getattr(recording, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
