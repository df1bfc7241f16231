"""tomcom's recordings and tables in pandas, and its program from Python.

    import tomcom

    trial = tomcom.read("sessions/2026-03-14-P07-1")
    trial.presses
    recordings = tomcom.simulate("sessions/default.toml", trials=20, out="pilot")
    tomcom.study("pilot").trials

Reading needs no program. Of every table the columns are the same in each recording, also where it has no rows.
"""

from .program import ProgramFailed, Study, program, run, simulate, study
from .recording import Recording, read, recordings

__all__ = ["ProgramFailed", "Recording", "Study", "program", "read", "recordings", "run", "simulate", "study"]
