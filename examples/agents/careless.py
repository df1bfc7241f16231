"""A participant that plays badly: it presses a random button every two seconds, and waits now and then.

    # sessions/careless.toml
    [participant]
    kind = "external"
    external = "python examples/agents/careless.py"
    gaze = "none"
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "packaging" / "python"))  # where the package is not installed
from tomcom.agent import Move, Participant, ParticipantBegin, ParticipantQuestion, run  # noqa: E402


class Careless(Participant):
    name = "careless"

    def begin(self, told: ParticipantBegin) -> None:
        self.buttons = [button["name"] for button in told.scene["buttons"]]

    def act(self, question: ParticipantQuestion) -> Move:
        if self.random.random() < 0.1:
            return Move(after_s=3.0)
        return Move(self.random.choice(self.buttons), after_s=self.random.uniform(1.0, 3.0))


if __name__ == "__main__":
    run(Careless())
