"""The rules of a kitchen, written a second time from docs/writing-a-kitchen.md alone: what a press does, counted by nobody's help."""

import tomllib
from itertools import product

EMPTY = frozenset()


class Kitchen:
    """A kitchen from the texts of a layout and a recipe file. Contents are sets of items."""

    def __init__(self, layout_text, recipes_text):
        layout, recipes = tomllib.loads(layout_text), tomllib.loads(recipes_text)
        self.layout, self.recipes = layout, recipes
        states = {one["name"]: one.get("states") for one in recipes["ingredient"]}
        self.items = [f"{name} {state}" if state else name for name, of in states.items() for state in of or [""]]
        self.stored = {name: f"{name} {of[0]}" if of else name for name, of in states.items()}
        self.slot_of = {item: slot["name"] for slot in recipes["slot"] for item in slot["items"]}
        self.dishes = {dish["name"]: frozenset(dish["items"]) for dish in recipes["dish"]}
        self.orders = [order["name"] for order in layout["order"]]
        self.hands = {hand["agent"]: hand["name"] for hand in layout["hand"]}
        self.places = {place["name"]: place for place in layout["place"]}
        self.board = next(name for name, place in self.places.items() if place.get("stacks"))
        self.plate = next(name for name, place in self.places.items() if place.get("serves"))
        self.processes = {process["name"]: process for process in recipes["process"]}

    def stacks(self):
        """Every stack of two or more items: at most one of each slot."""
        choices = [[None, *slot["items"]] for slot in self.recipes["slot"]]
        stacks = (frozenset(item for item in choice if item) for choice in product(*choices))
        return [stack for stack in stacks if len(stack) > 1]

    def accepts(self, place, content):
        groups = {group["name"]: set(group["made_of"]) for group in self.recipes.get("group", [])}
        return any(
            kind == "anything"
            or kind == "ingredients" and len(content) == 1
            or kind == "dishes" and content in self.dishes.values()
            or kind in groups and content <= groups[kind]
            for kind in self.places[place]["accepts"]
        )

    def state_space(self):
        """The number of values of each location, and of each recipe."""
        contents = [EMPTY, *({item} for item in self.items), *self.stacks()]
        contents = [frozenset(content) for content in contents]
        sizes = {order: len(self.dishes) + 2 for order in self.orders}
        sizes |= {hand: len(contents) for hand in self.hands.values()}
        for place in self.places:
            sizes[place] = 1 + sum(self.accepts(place, content) for content in contents if content)
        for dish, stack in self.dishes.items():
            sizes[f"recipe of {dish}"] = len(self.variants(stack))
        return sizes

    def variants(self, stack):
        """What may be taken for a recipe, the true one among it."""
        found = {stack}
        for deviation in self.recipes.get("deviation", []):
            if not stack & set(deviation["dishes_with"]):
                continue
            kept = {self.slot_of[item]: item for item in stack}
            slots = [(slot["slot"], slot["items"]) for slot in deviation["slots"]]
            if deviation["combine"] == "all":
                for choice in product(*(items for _, items in slots)):
                    changed = kept | dict(zip((slot for slot, _ in slots), choice))
                    found.add(frozenset(changed.values()))
            else:
                for slot, items in slots:
                    found |= {frozenset((kept | {slot: item}).values()) for item in items}
        return found


class Trial:
    """A trial that is followed press by press."""

    def __init__(self, kitchen):
        self.kitchen = kitchen
        places = [*kitchen.hands.values(), *kitchen.places]
        self.content = dict.fromkeys(places, EMPTY)
        self.wanted = {}

    def press(self, agent, button):
        """Applies a press; whether it had an effect, and the served order if it served one."""
        kitchen, content = self.kitchen, self.content
        hand = kitchen.hands[agent]
        held = content[hand]
        if button.startswith("take ") and button not in content:
            if held:
                return False, None
            content[hand] = frozenset([kitchen.stored[button.removeprefix("take ")]])
        elif button.startswith("serve "):
            order = kitchen.orders[int(button.removeprefix("serve ")) - 1]
            dish = self.wanted.get(order)
            if dish is None or content[kitchen.plate] != kitchen.dishes[dish]:
                return False, None
            content[kitchen.plate] = EMPTY
            del self.wanted[order]
            return True, order
        elif button == "trash":
            content[hand] = EMPTY
            return bool(held), None
        elif button in kitchen.processes:
            return self.process(kitchen.processes[button], hand), None
        else:
            return self.use(hand, held, button), None
        return True, None

    def process(self, process, hand):
        place = hand if process["at"] == "hand" else process["at"]
        steps = {frozenset([step["from"]]): frozenset([step["to"]]) for step in process["steps"]}
        if self.content[place] not in steps:
            return False
        self.content[place] = steps[self.content[place]]
        return True

    def use(self, hand, held, place):
        there = self.content[place]
        if held and there:
            slots = [self.kitchen.slot_of.get(item) for item in held | there]
            if place != self.kitchen.board or None in slots or len(set(slots)) < len(held) + len(there):
                return False
            self.content[place], self.content[hand] = held | there, EMPTY
            return True
        if not held and not there or held and not self.kitchen.accepts(place, held):
            return False
        self.content[place], self.content[hand] = held, there
        return True
