//! Decisions: the cost to go of a state together with the costs to go after every button of an agent.
//!
//! A press lowers the cost to go by at most 1; a press that another press can undo raises the cost by at most 1.
//! Together with the lower bound this decides most buttons without a plan.

use super::cache::{DecisionCosts, MAX_BUTTONS};
use super::classes::MAX_TARGETS;
use super::fidelity::Fidelity;
use super::store::{CacheSlot, CostToGo, SLOT_BITS, SuccessorState, UNREACHABLE};
use crate::kitchen::{Agent, ButtonAction, ContentId, LocationId, Recipes, State};

impl CostToGo {
    /// Cost to go of the state and after every button of `agent`; one cache look-up if the decision was computed
    /// before.
    #[inline]
    pub fn decision(&mut self, state: State, recipes: &Recipes, agent: Agent) -> &DecisionCosts {
        self.decision_with(Fidelity::Searched, state, recipes, agent)
    }

    /// Cost to go of the state and after every button of `agent`, at a given fidelity. Values of other fidelities are
    /// not reused, so that a result never depends on earlier requests.
    #[inline]
    pub fn decision_with(
        &mut self,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
        agent: Agent,
    ) -> &DecisionCosts {
        let (mut targets, count) = self.targets(state, recipes);
        let question = question(&targets, fidelity, agent);
        let (index, known) = self.decisions.find(state, question);
        if !known {
            let alike = self.stand_in(state, &mut targets[..count]);
            let (there, known) = self.decisions.find(alike, question);
            if !known {
                self.decide(there, question, fidelity, alike, recipes, agent);
            }
            let found = *self.decisions.get(there);
            self.decisions.set(index, state, question, found.here, found.after);
        }
        self.decisions.get(index)
    }

    /// Prefetches the cache line of a decision that will be requested soon.
    #[inline]
    pub fn prefetch(&self, fidelity: Fidelity, state: State, recipes: &Recipes, agent: Agent) {
        let question = question(&self.targets(state, recipes).0, fidelity, agent);
        std::hint::black_box(self.decisions.fetch(state, question));
    }

    /// Bit set of the buttons of `agent` whose press lowers the cost to go.
    pub fn nearer(&mut self, fidelity: Fidelity, state: State, recipes: &Recipes, agent: Agent) -> u64 {
        if fidelity != Fidelity::Searched {
            let buttons = self.kitchen.buttons[agent.index()].len();
            let decision = self.decision_with(fidelity, state, recipes, agent);
            let after = decision.after[..buttons].iter().enumerate();
            return after.map(|(button, &after)| u64::from(after < decision.here) << button).sum();
        }
        let kept = self.kept(state, recipes);
        let nexts = self.nexts(state, kept, recipes, agent);
        let here = self.value_kept(Fidelity::Searched, state, kept);
        let mut nearer = 0;
        for next in &nexts {
            nearer |= u64::from(self.is_below(here, next.state, next.kept)) << next.button;
        }
        self.nexts = nexts;
        nearer
    }

    /// An equivalent state in which each useless content is replaced by a representative with the same possible
    /// presses: the decisions are the same, and fewer distinct states have to be cached.
    fn stand_in(&mut self, state: State, targets: &mut [ContentId]) -> State {
        targets.sort_unstable();
        if targets.is_empty() {
            return state;
        }
        let slot = self.slot(targets);
        self.make_goal(slot, targets);
        let Some(goal) = &self.goals[slot] else { return state };
        let mut alike = state;
        for location in self.ground.places() {
            let location = LocationId(location as u8);
            alike.set_content(location, goal.stands_for[state.content(location).index()]);
        }
        alike
    }

    /// Computes the costs to go for a decision and stores them in the cache.
    fn decide(
        &mut self,
        index: usize,
        question: u32,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
        agent: Agent,
    ) {
        self.counts.decisions_missed += 1;
        let (here, after) = match fidelity {
            Fidelity::Searched => self.each(Fidelity::Searched, state, recipes, agent),
            Fidelity::PlanBound => self.close(state, recipes, agent),
            Fidelity::LowerBound => self.each(Fidelity::LowerBound, state, recipes, agent),
        };
        self.decisions.set(index, state, question, here, after);
    }

    /// Computes the costs to go of a decision independently, one by one.
    fn each(&mut self, fidelity: Fidelity, state: State, recipes: &Recipes, agent: Agent) -> (u8, [u8; MAX_BUTTONS]) {
        let kept = self.kept(state, recipes);
        let nexts = self.nexts(state, kept, recipes, agent);
        let here = self.value_kept(fidelity, state, kept) as u8;
        let mut after = [here; MAX_BUTTONS];
        for next in &nexts {
            after[next.button] = self.value_kept(fidelity, next.state, next.kept) as u8;
        }
        self.nexts = nexts;
        (here, after)
    }

    /// Computes the costs to go of a decision together, from bounds and plans.
    fn close(&mut self, state: State, recipes: &Recipes, agent: Agent) -> (u8, [u8; MAX_BUTTONS]) {
        let kept = self.kept(state, recipes);
        let mut nexts = self.nexts(state, kept, recipes, agent);
        let most_here = self.bracket(state, kept, UNREACHABLE).1.unwrap_or(UNREACHABLE);
        let mut here = most_here;
        for next in &mut nexts {
            next.bracket = self.bracket(next.state, next.kept, most_here);
            let (lower, upper) = next.bracket;
            here = here.min(upper.unwrap_or(lower) + 1);
        }
        let mut after = [here.min(UNREACHABLE) as u8; MAX_BUTTONS];
        for next in &nexts {
            let action = self.kitchen.buttons[agent.index()][next.button].action;
            let value = match (next.bracket, self.can_be_undone(state, agent, action)) {
                ((_, None), true) => here + 1,
                ((lower, None), false) => lower,
                ((_, Some(upper)), true) => upper.min(here + 1),
                ((_, Some(upper)), false) => upper,
            };
            after[next.button] = value.min(UNREACHABLE) as u8;
        }
        self.nexts = nexts;
        (here as u8, after)
    }

    /// The states after each of the agent's buttons, with their cache slots. All cache lines are prefetched together.
    /// The caller must return the buffer after use.
    fn nexts(&mut self, state: State, here: CacheSlot, recipes: &Recipes, agent: Agent) -> Vec<SuccessorState> {
        let kitchen = self.kitchen.clone();
        let mut nexts = std::mem::take(&mut self.nexts);
        nexts.clear();
        for (index, button) in kitchen.buttons[agent.index()].iter().enumerate() {
            let Some(there) = kitchen.act(state, recipes, agent, button.action) else { continue };
            let kept = match (button.action, here) {
                (ButtonAction::Serve(_), _) => self.kept(there, recipes),
                (_, CacheSlot::At(slot, key)) => CacheSlot::At(slot, self.moved(slot, key, state, there)),
                (_, CacheSlot::Always(value)) => CacheSlot::Always(value),
            };
            nexts.push(SuccessorState { button: index, state: there, kept, bracket: (0, None) });
        }
        let keys = nexts.iter().filter_map(|next| match next.kept {
            CacheSlot::At(_, key) => Some(key),
            CacheSlot::Always(_) => None,
        });
        std::hint::black_box(keys.fold(0, |fetched, key| fetched ^ self.cache.fetch(key)));
        nexts
    }

    /// The cache key of a state, computed incrementally from the key of another state with the same orders.
    #[inline]
    fn moved(&self, slot: usize, key: u64, from: State, to: State) -> u64 {
        let Some(goal) = &self.goals[slot] else { return key };
        let mut differs = from.bits() ^ to.bits();
        let mut moved = key;
        while differs != 0 {
            let index = differs.trailing_zeros() / u8::BITS;
            let location = LocationId(index as u8);
            let [before, after] = [from, to].map(|state| goal.key_part(location, state.content(location)));
            moved = moved.wrapping_add(after.wrapping_sub(before) << SLOT_BITS);
            differs &= !(u128::from(u8::MAX) << (u8::BITS * index));
        }
        moved
    }

    /// Whether one further press of the same agent can undo this action.
    fn can_be_undone(&self, state: State, agent: Agent, action: ButtonAction) -> bool {
        let held = state.content(self.kitchen.hands[agent.index()]);
        match action {
            ButtonAction::Take(_) => self.trashes[agent.index()],
            ButtonAction::Trash => self.takes[agent.index()][held.index()],
            ButtonAction::Use(location) => {
                let there = state.content(location);
                // Stacking cannot be undone; a pick-up can be undone if the place accepts the item.
                there.is_empty() || held.is_empty() && self.kitchen.accepts(location, there)
            }
            ButtonAction::Process(_) | ButtonAction::Serve(_) => false,
        }
    }
}

/// Hash of a request for a decision: target dishes in the order of the orders, fidelity, agent.
#[inline]
fn question(targets: &[ContentId; MAX_TARGETS], fidelity: Fidelity, agent: Agent) -> u32 {
    u32::from(targets[0].0) | u32::from(targets[1].0) << 8 | (agent as u32) << 16 | (fidelity as u32) << 17
}
