"""A chat model over an HTTP API: the state in words is the prompt, the answer is one word: the name of a signal, or none.

    export CHAT_URL=https://…/v1/chat/completions CHAT_MODEL=… CHAT_KEY=…
    tomcom operate sessions/default.toml --condition assistant --concept "python examples/agents/chat.py"

Any server with the usual chat completions works, also one on this computer. The answers are in the recording, so it can be
replayed and verified without the model.
"""

import json
import os
import sys
import urllib.request
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "packaging" / "python"))  # where the package is not installed
from tomcom.agent import Advice, Concept, ConceptBegin, ConceptQuestion, Happening, run  # noqa: E402

TASK = """A person and a robot cook together in a kitchen. You see everything and may help the person, who may have a recipe wrong or
not have seen a change. Each signal interrupts the person, so send one only if it saves several button presses. Answer with JSON
alone: {"signal": NAME or null, "why": one short sentence}."""


def words(one: Happening) -> str:
    match one.what:
        case "press":
            verdict = " (an error)" if one.error else "" if one.effective else " (no effect)"
            return f"{one.by} pressed {one.button}{verdict}"
        case "look":
            return f"the person looked at {one.location} for {one.for_s:.1f} s"
        case "order":
            return f"{one.order} wants {one.dish}"
        case "signal":
            return f"signal shown: {one.signal}"
        case _:
            return one.what.replace("_", " ")


class Chat(Concept):
    name = f"chat model {os.environ.get('CHAT_MODEL', '')}".strip()

    def begin(self, told: ConceptBegin) -> None:
        self.dishes = {dish.name: ", ".join(dish.items) for dish in told.kitchen.dishes}
        self.cost = told.cost_of_communication

    def prompt(self, question: ConceptQuestion) -> str:
        state = "; ".join(f"{place}: {content}" for place, content in question.state.items())
        menu = "; ".join(f"{dish}: {items}" for dish, items in self.dishes.items())
        since = "; ".join(words(one) for one in question.since) or "nothing"
        signals = ", ".join(str(signal) for signal in question.signals) or "none"
        return (
            f"Recipes: {menu}.\nNow: {state}.\nSince you were last asked: {since}.\n"
            f"Signals that you can send: {signals}. A signal must save more than {self.cost} presses."
        )

    def advise(self, question: ConceptQuestion) -> Advice:
        messages = [{"role": "system", "content": TASK}, {"role": "user", "content": self.prompt(question)}]
        body = json.dumps({"model": os.environ.get("CHAT_MODEL", "local"), "messages": messages, "temperature": 0})
        headers = {"Content-Type": "application/json"}
        if key := os.environ.get("CHAT_KEY"):
            headers["Authorization"] = f"Bearer {key}"
        request = urllib.request.Request(os.environ["CHAT_URL"], body.encode(), headers)
        try:
            with urllib.request.urlopen(request, timeout=8) as response:
                said = json.load(response)["choices"][0]["message"]["content"]
            answer = json.loads(said[said.index("{") : said.rindex("}") + 1])
            wanted, why = answer.get("signal"), str(answer.get("why", ""))
        except (OSError, ValueError, KeyError, IndexError) as error:
            # What the model says wrongly is silence, with the reason in the recording.
            return Advice.silent(f"no answer of the model: {error}")
        signal = next((signal for signal in question.signals if str(signal) == wanted), None)
        return Advice(send=signal, reason=why)


if __name__ == "__main__":
    run(Chat())
