"""A Bayesian agent on inferactively-pymdp: infers what the participant believes about each order's recipe, and acts by expected
free energy.

For each dish there is a hidden state with two values: the participant believes the true recipe, or another one. A press that was
an error speaks for the other one, a good press for the true one; knowledge decays slowly, and a recipe that is shown restores it.
The agent's actions are to stay silent or to show the recipe; it prefers good presses, and a signal has a price.

    pip install inferactively-pymdp==0.0.7.1
    tomcom simulate sessions/default.toml --condition assistant --concept "python examples/agents/bayes.py"
"""

import sys
from pathlib import Path

import numpy as np
from pymdp import utils
from pymdp.agent import Agent

sys.path.append(str(Path(__file__).parents[2] / "packaging" / "python"))  # where the package is not installed
from tomcom.agent import Advice, Concept, ConceptBegin, ConceptQuestion, Signal, run  # noqa: E402

KNOWS, ERRS = 0, 1  # hidden states: the believed recipe is the true one, or another
SILENT, SHOW = 0, 1  # actions
GOOD, BAD, NOTHING = 0, 1, 2  # observations of the participant's last press; NOTHING: it says nothing about this order


def model() -> Agent:
    """A model of one order's recipe in the participant's mind."""
    likelihood = utils.obj_array(1)
    # P(observation | belief): columns are the hidden states.
    likelihood[0] = np.array([[0.55, 0.35], [0.05, 0.25], [0.40, 0.40]])
    transition = utils.obj_array(1)
    stays = np.array([[0.995, 0.02], [0.005, 0.98]])  # knowledge decays, and errors are seldom noticed
    shown = np.array([[0.98, 0.95], [0.02, 0.05]])
    transition[0] = np.stack([stays, shown], axis=2)
    prior = utils.obj_array(1)
    prior[0] = np.array([0.8, 0.2])
    preferences = utils.obj_array(1)
    preferences[0] = np.array([0.5, -3.0, 0.0])
    habits = np.array([0.97, 0.03])  # the price of a signal
    mind = Agent(A=likelihood, B=transition, C=preferences, D=prior, E=habits, policy_len=1, action_selection="deterministic")
    # Inference starts from the prior, and each step from the last one under the last action.
    mind.qs, mind.action = prior.copy(), np.array([SILENT])
    return mind


class Bayes(Concept):
    name = "Bayes (pymdp)"

    def begin(self, told: ConceptBegin) -> None:
        self.kitchen = told.kitchen
        self.minds: dict[str, Agent] = {}  # by order, while it is open
        self.dishes: dict[str, str] = {}

    def take(self, question: ConceptQuestion) -> None:
        """Updates what the participant believes about each open order by what happened."""
        for one in question.since:
            if one.what == "order" and one.order and one.dish:
                self.minds[one.order], self.dishes[one.order] = model(), one.dish
            elif one.what == "order_cleared" and one.order in self.minds:
                del self.minds[one.order], self.dishes[one.order]
            elif one.what == "press" and one.by == "human":
                for mind in self.minds.values():
                    mind.infer_states([BAD if one.error else GOOD])
            elif one.what == "signal" and one.signal and one.signal.target in self.minds:
                mind = self.minds[one.signal.target]
                mind.action = np.array([SHOW])
                mind.infer_states([NOTHING])
                mind.action = np.array([SILENT])

    def belief(self) -> dict[str, dict[str, float]]:
        """As distributions over recipes: what is not the true recipe is spread over the others."""
        told = {}
        for order, mind in self.minds.items():
            aspect = next((one for one in self.kitchen.aspects if one.name == self.recipe_of(order)), None)
            if aspect is None or len(aspect.values) < 2:
                continue
            knows = float(mind.qs[0][KNOWS])
            rest = (1.0 - knows) / (len(aspect.values) - 1)
            told[aspect.name] = {value: rest for value in aspect.values} | {aspect.values[0]: knows}
        return told

    def recipe_of(self, order: str) -> str:
        """The name of the aspect with the recipe of an order's dish."""
        names = [one.name for one in self.kitchen.aspects]
        dish = self.dishes[order]
        return next((name for name in names if dish in name and name != dish), dish)

    def advise(self, question: ConceptQuestion) -> Advice:
        self.take(question)
        best: tuple[float, Signal, float] | None = None
        for order, mind in self.minds.items():
            signal = question.about(order)
            if signal is None:
                continue
            policies, _ = mind.infer_policies()
            show = float(policies[SHOW])
            if show > 0.5 and (best is None or show > best[0]):
                best = (show, signal, float(mind.qs[0][ERRS]))
        belief = self.belief()
        if best is None:
            return Advice.silent(belief=belief)
        return Advice(send=best[1], reason=f"another recipe in mind with probability {best[2]:.2f}", belief=belief)


if __name__ == "__main__":
    run(Bayes())
