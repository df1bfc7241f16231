use super::Fidelity;
use super::ground::MAX_TARGETS;
use super::plan::{BLOCKED, RankedAssignments};
use super::search::{BestFirstSearch, FAR, NEAR};
use super::store::{CacheSlot, CostToGo, DecisionCosts, MAX_BUTTONS, SLOT_BITS, SuccessorState, UNREACHABLE};
use crate::kitchen::{Agent, ButtonAction, ContentId, LocationId, OrderContent, Recipes, State};

impl CostToGo {
    /// C(s, recipes): number of presses until all present orders are served; 0 without orders, `UNREACHABLE` if the
    /// orders cannot be served.
    pub fn all_orders(&mut self, state: State, recipes: &Recipes) -> u32 {
        self.all_orders_with(Fidelity::Searched, state, recipes)
    }

    /// Number of presses until all present orders are served, at a given fidelity.
    pub(crate) fn all_orders_with(&mut self, fidelity: Fidelity, state: State, recipes: &Recipes) -> u32 {
        let (mut targets, count) = self.targets(state, recipes);
        self.cost(fidelity, state, &mut targets[..count])
    }

    /// C_k(s, recipes): number of presses until the order at this location is served; 0 without an order.
    pub fn order(&mut self, state: State, recipes: &Recipes, order: LocationId) -> u32 {
        self.order_with(Fidelity::Searched, state, recipes, order)
    }

    /// Number of presses until the order at this location is served, at a given fidelity.
    pub(crate) fn order_with(&mut self, fidelity: Fidelity, state: State, recipes: &Recipes, order: LocationId) -> u32 {
        match state.order(order) {
            OrderContent::Dish(dish) => self.cost(fidelity, state, &mut [recipes.get(dish)]),
            _ => 0,
        }
    }

    /// Whether the order's cost to go is below `limit`, where `limit` is at most one press above the cost; cheaper than
    /// computing the cost to go.
    pub(crate) fn order_is_below(
        &mut self,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
        order: LocationId,
        limit: u32,
    ) -> bool {
        match state.order(order) {
            OrderContent::Dish(dish) if fidelity == Fidelity::Searched => {
                let kept = self.kept_for(state, &mut [recipes.get(dish)]);
                self.is_below(limit, state, kept)
            }
            _ => self.order_with(fidelity, state, recipes, order) < limit,
        }
    }

    pub(super) fn cost(&mut self, fidelity: Fidelity, state: State, targets: &mut [ContentId]) -> u32 {
        if targets.is_empty() {
            return 0;
        }
        let (slot, key) = self.key_of_state(state, targets);
        self.value_kept(fidelity, state, CacheSlot::At(slot, key))
    }

    pub(super) fn value_kept(&mut self, fidelity: Fidelity, state: State, kept: CacheSlot) -> u32 {
        match kept {
            CacheSlot::At(slot, key) => {
                self.known(fidelity, key).unwrap_or_else(|| self.compute_for(fidelity, key, slot, state))
            }
            CacheSlot::Served => 0,
        }
    }

    /// The lower bound of a state's cost to go and, if the bound is at most `most`, the length of the state's best
    /// plan.
    pub(super) fn bracket(&mut self, state: State, kept: CacheSlot, most: u32) -> (u32, Option<u32>) {
        let (slot, key) = match kept {
            CacheSlot::At(slot, key) => (slot, key),
            CacheSlot::Served => return (0, Some(0)),
        };
        let known = self.known(Fidelity::LowerBound, key);
        if let Some(lower) = known {
            if lower > most {
                return (lower, None);
            }
            if let Some(upper) = self.known(Fidelity::PlanBound, key) {
                return (lower, Some(upper));
            }
        }
        let goal = self.goal(slot).clone();
        let classes = self.classes(&goal, state);
        let rating = RankedAssignments::new(&self.ground, &goal, &classes);
        let lower = known.unwrap_or_else(|| self.keep(Fidelity::LowerBound, key, rating.lower));
        if lower > most {
            return (lower, None);
        }
        let upper = match rating.close_upper(&self.ground, &goal, &classes) {
            BLOCKED => self.solve(Fidelity::PlanBound, slot, &goal, &classes),
            upper => upper,
        };
        (lower, Some(self.keep(Fidelity::PlanBound, key, upper)))
    }

    /// Whether the cost to go of a state is below `limit`, which is at most one press above the cost.
    pub(super) fn is_below(&mut self, limit: u32, state: State, kept: CacheSlot) -> bool {
        if limit == 0 {
            return false;
        }
        match (kept, self.bracket(state, kept, limit - 1)) {
            (_, (_, None)) => false,
            (CacheSlot::At(slot, _), (lower, Some(upper))) if upper >= limit => self.has_way(slot, state, lower, limit),
            (_, (_, Some(upper))) => upper < limit,
        }
    }

    /// Whether a search finds a solution with fewer than `limit` presses.
    fn has_way(&mut self, slot: usize, state: State, lower: u32, limit: u32) -> bool {
        let goal = self.goal(slot).clone();
        let classes = self.classes(&goal, state);
        let mut finds =
            |reach| BestFirstSearch::new(self, slot, &goal, limit, reach, true).run(&classes, limit - 1) < limit;
        let far = limit >= lower + goal.targets.len() as u32;
        finds(NEAR) || far && finds(FAR)
    }
}

// Decisions: the cost to go of a state together with the costs to go after every button of an agent. A press lowers the
// cost to go by at most 1; a press that another press can undo raises the cost by at most 1. Together with the lower bound
// this decides most buttons without a plan.

impl CostToGo {
    /// Cost to go of the state and after every button of `agent`; one cache look-up if the decision was computed
    /// before.
    #[inline]
    pub fn decision(&mut self, state: State, recipes: &Recipes, agent: Agent) -> DecisionCosts {
        self.decision_with(Fidelity::Searched, state, recipes, agent)
    }

    /// Cost to go of the state and after every button of `agent`, at a given fidelity. Values of other fidelities are
    /// not reused, so that a result never depends on earlier requests.
    #[inline]
    pub(crate) fn decision_with(
        &mut self,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
        agent: Agent,
    ) -> DecisionCosts {
        let (mut targets, count) = self.targets(state, recipes);
        let question = question(&targets, fidelity, agent);
        if let Some(known) = self.decisions.get(state, question) {
            return known;
        }
        let alike = self.stand_in(state, &mut targets[..count]);
        let costs = match self.decisions.get(alike, question) {
            Some(known) => known,
            None => self.decide(question, fidelity, alike, recipes, agent),
        };
        self.decisions.set(state, question, &costs);
        costs
    }

    /// Prefetches the cache line of a decision that will be requested soon.
    #[inline]
    pub(crate) fn prefetch(&self, fidelity: Fidelity, state: State, recipes: &Recipes, agent: Agent) {
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
    fn stand_in(&self, state: State, targets: &mut [ContentId]) -> State {
        targets.sort_unstable();
        if targets.is_empty() {
            return state;
        }
        let goal = self.goal(self.slot(targets));
        let mut alike = state;
        for location in self.ground.places() {
            let location = LocationId(location as u8);
            alike.set_content(location, goal.stands_for[state.content(location).index()]);
        }
        alike
    }

    fn decide(
        &mut self,
        question: u32,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
        agent: Agent,
    ) -> DecisionCosts {
        self.decisions_missed += 1;
        let (here, after) = match fidelity {
            Fidelity::PlanBound => self.close(state, recipes, agent),
            Fidelity::Searched | Fidelity::LowerBound => self.each(fidelity, state, recipes, agent),
        };
        let costs = DecisionCosts { here, after };
        self.decisions.set(state, question, &costs);
        costs
    }

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
                (_, CacheSlot::Served) => CacheSlot::Served,
            };
            nexts.push(SuccessorState { button: index, state: there, kept, bracket: (0, None) });
        }
        let keys = nexts.iter().filter_map(|next| match next.kept {
            CacheSlot::At(_, key) => Some(key),
            CacheSlot::Served => None,
        });
        std::hint::black_box(keys.fold(0, |fetched, key| fetched ^ self.cache.fetch(key)));
        nexts
    }

    /// The cache key of a state, computed incrementally from the key of another state with the same orders.
    #[inline]
    fn moved(&self, slot: usize, key: u64, from: State, to: State) -> u64 {
        let goal = self.goal(slot);
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
