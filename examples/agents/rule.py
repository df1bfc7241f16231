"""A rule: after two errors of the participant, show the recipe of the order that is open for longest.

    tomcom simulate sessions/default.toml --condition assistant --concept "python examples/agents/rule.py"
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "packaging" / "python"))  # where the package is not installed
from tomcom.agent import Advice, Concept, ConceptBegin, ConceptQuestion, run  # noqa: E402

ERRORS = 2


class AfterTwoErrors(Concept):
    name = f"after {ERRORS} errors"

    def begin(self, told: ConceptBegin) -> None:
        self.errors = 0
        self.orders: list[str] = []

    def advise(self, question: ConceptQuestion) -> Advice:
        for one in question.since:
            if one.what == "press" and one.by == "human":
                self.errors = self.errors + 1 if one.error else self.errors
            elif one.what == "order" and one.order:
                self.orders.append(one.order)
            elif one.what == "order_cleared":
                self.orders = [order for order in self.orders if order != one.order]
        signal = next((known for order in self.orders if (known := question.about(order))), None)
        if self.errors < ERRORS or signal is None:
            return Advice.silent()
        self.errors = 0
        return Advice(send=signal, reason=f"{ERRORS} errors since the last recipe")


if __name__ == "__main__":
    run(AfterTwoErrors())
