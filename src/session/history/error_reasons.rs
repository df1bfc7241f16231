//! Why a press of the human was an error, in words. The reason follows from the true state and recipes, the press and
//! the human's best press: it is the same live, in replays, and for raters, and tells nothing about beliefs.

use super::{event_words, wording};
use crate::order_needs::{ItemProgress, NeededItem, OrderNeeds, OrderWork, becomes};
use crate::{Session, TimelineEntry, TimelineEvent};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, ContentId, Kitchen, LocationId, State};
use tomcom_core::measures::JudgedPress;

/// An error of the human with its reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExplainedError {
    /// Session time of the press.
    pub time: SessionTime,
    /// "take salmon", "cooking pot".
    pub press: String,
    /// "order 1 needs tuna", "the hand is empty".
    pub why: String,
    /// "cause (simulated participant): slip", if it is known. Raters are not shown it.
    pub cause: Option<String>,
    /// "costs 2 presses".
    pub cost: String,
}

impl ExplainedError {
    /// The press with its reason, then cause, cost, and what was believed wrong, which is long.
    pub fn told(&self, believed: Option<String>) -> String {
        format!("{}: {}", self.press, self.told_without_press(believed))
    }

    pub fn told_without_press(&self, believed: Option<String>) -> String {
        let parts = [Some(&self.why), self.cause.as_ref(), Some(&self.cost), believed.as_ref()];
        parts.into_iter().flatten().map(String::as_str).collect::<Vec<_>>().join("; ")
    }

    /// The errors among judged presses of a session, whose timeline goes to the last of them at least. Their reasons need
    /// no cost to go beyond that of the judgements.
    pub fn among(session: &Session, judged: &[JudgedPress]) -> Vec<ExplainedError> {
        let (mut work, mut followed) = (OrderWork::default(), 0);
        let errors = judged.iter().filter(|press| press.verdict.error);
        let explained = errors.map(|press| {
            let until = session.timeline.partition_point(|entry| entry.time < press.time);
            work.follow(&session.kitchen, &session.timeline[followed..until]);
            followed = until;
            let orders = work.needs(&session.kitchen, press.before);
            ExplainedError {
                time: press.time,
                press: wording::button(&session.kitchen, Agent::Human, press.button),
                why: Reasons { session, press, orders, earlier: &session.timeline[..until] }.why(),
                cause: event_words::cause(&session.kitchen, press),
                cost: event_words::cost(press),
            }
        });
        explained.collect()
    }
}

/// What the reason of an error follows from.
struct Reasons<'a> {
    session: &'a Session,
    press: &'a JudgedPress,
    /// What the orders needed before the press.
    orders: Vec<OrderNeeds>,
    /// What happened before it.
    earlier: &'a [TimelineEntry],
}

impl Reasons<'_> {
    /// Why the press was an error: why it had no effect; else what the orders need instead; else the better press.
    fn why(&self) -> String {
        let (kitchen, state, orders) = (&*self.session.kitchen, self.press.before, self.orders.as_slice());
        let action = kitchen.button(Agent::Human, self.press.button).action;
        match kitchen.no_effect(state, Agent::Human, self.press.button) {
            Some((NoEffectReason::NotServed, order)) => return not_served(kitchen, state, orders, order),
            Some((NoEffectReason::AlreadyProcessed, place)) => return self.processed_already(place),
            Some((why, about)) => return wording::because(kitchen, why, about, kitchen.content_label(state, about)),
            None => {}
        }
        let hand = kitchen.hands[Agent::Human.index()];
        let held = state.content(hand);
        let told = match action {
            ButtonAction::Take(item) => not_needed(kitchen, orders, item, None),
            ButtonAction::Process(process) => {
                let place = kitchen.processes[usize::from(process)].place.unwrap_or(hand);
                kitchen
                    .processed(process, state.content(place))
                    .and_then(|made| made_for_nothing(kitchen, orders, made))
            }
            ButtonAction::Use(place) if held.is_empty() => {
                not_needed(kitchen, orders, state.content(place), Some(place))
            }
            ButtonAction::Use(place) => (place == kitchen.board)
                .then(|| stacked(kitchen, state, orders, place, held))
                .flatten()
                .or_else(|| (place == kitchen.plate).then(|| incomplete(kitchen, orders, held)).flatten())
                .or_else(|| not_needed(kitchen, orders, held, Some(hand))),
            ButtonAction::Trash => needed_by(kitchen, orders, hand, held),
            ButtonAction::Serve(_) => None,
        };
        told.unwrap_or_else(|| better(kitchen, state, orders, self.press.verdict.best))
    }

    /// That the place holds already what the press was to make, and who made it when: "it is cut tuna already, by the robot
    /// 2 s ago".
    fn processed_already(&self, place: LocationId) -> String {
        let kitchen = &self.session.kitchen;
        let made = self.press.before.content(place);
        let came = self.earlier.iter().rev().find_map(|entry| match entry.what {
            TimelineEvent::Press { agent, button, before, after, .. }
                if after.content(place) == made && before.content(place) != made =>
            {
                Some((entry.time, agent, kitchen.button(agent, button).action))
            }
            _ => None,
        });
        let by = match came {
            Some((time, agent, ButtonAction::Process(_))) => {
                let clock = |at: SessionTime| self.session.trial_clock_at(at);
                let ago = clock(self.press.time) - clock(time);
                let ago =
                    if ago.as_secs_f64() < 60.0 { format!("{:.0} s", ago.as_secs_f64()) } else { ago.to_string() };
                format!(", by the {} {ago} ago", agent.name())
            }
            _ => String::new(),
        };
        format!("it is {} already{by}", word(kitchen, made))
    }
}

/// The better press, and what it is for: "take tuna would be better: order 2 needs tuna".
fn better(kitchen: &Kitchen, state: State, orders: &[OrderNeeds], best: Option<ButtonId>) -> String {
    let Some(best) = best else { return "waiting for the robot would be better".to_string() };
    let told = format!("{} would be better", wording::button(kitchen, Agent::Human, best));
    let made = match kitchen.button(Agent::Human, best).action {
        ButtonAction::Take(item) => Some((item, storage_name(kitchen, item))),
        ButtonAction::Process(process) => {
            let place = kitchen.processes[usize::from(process)].place;
            let place = place.unwrap_or(kitchen.hands[Agent::Human.index()]);
            kitchen.processed(process, state.content(place)).map(|made| (made, word(kitchen, made)))
        }
        ButtonAction::Use(_) | ButtonAction::Trash | ButtonAction::Serve(_) => None,
    };
    let needs = made.and_then(|(made, name)| {
        let is_for = |needed: &NeededItem| match needed.progress {
            ItemProgress::Stacked | ItemProgress::Ready(_) => false,
            ItemProgress::InWork(_) | ItemProgress::Missing => serves(kitchen, made, needed.item),
        };
        let needs = orders.iter().find(|needs| needs.items.iter().any(is_for))?;
        Some(format!(": {} needs {name}", label(kitchen, needs.order)))
    });
    told + &needs.unwrap_or_default()
}

fn label(kitchen: &Kitchen, location: LocationId) -> String {
    kitchen.location(location).label()
}

fn word(kitchen: &Kitchen, content: ContentId) -> &str {
    &kitchen.content(content).wording
}

/// "cut tuna + nori".
fn list(kitchen: &Kitchen, items: impl Iterator<Item = ContentId>) -> String {
    items.map(|item| word(kitchen, item)).collect::<Vec<_>>().join(" + ")
}

/// Whether an order's recipe has this item.
fn has(needs: &OrderNeeds, item: ContentId) -> bool {
    needs.items.iter().any(|needed| needed.item == item)
}

/// Whether an item becomes this item of a recipe, or is it.
fn serves(kitchen: &Kitchen, content: ContentId, item: ContentId) -> bool {
    content == item || becomes(kitchen, content, item)
}

fn is_missing(needed: &NeededItem) -> bool {
    needed.progress == ItemProgress::Missing
}

/// The label of the storage that has what becomes the item, else the item's words.
fn storage_name(kitchen: &Kitchen, item: ContentId) -> &str {
    let storage = kitchen.storages.iter().find(|storage| serves(kitchen, storage.item, item));
    storage.map_or_else(|| word(kitchen, item), |storage| storage.label.as_str())
}

/// Why a content is not to be taken or put anywhere: it is there already, an order needs another one in its place, or no
/// order uses it. `at`: where it was, if it does not come from a storage.
fn not_needed(kitchen: &Kitchen, orders: &[OrderNeeds], content: ContentId, at: Option<LocationId>) -> Option<String> {
    let name = |item: ContentId| if at.is_none() { storage_name(kitchen, item) } else { word(kitchen, item) };
    if kitchen.content(content).is_stack() {
        let items = &kitchen.content(content).items;
        let is_for_one = orders.iter().any(|needs| items.iter().all(|&item| has(needs, item)));
        return (!is_for_one).then(|| format!("no order needs {}", word(kitchen, content)));
    }
    let all = || orders.iter().flat_map(|needs| needs.items.iter().map(move |needed| (needs.order, needed)));
    let counts = |needed: &NeededItem| match needed.progress {
        ItemProgress::Ready(place) | ItemProgress::InWork(place) => Some(place) == at,
        ItemProgress::Stacked => needed.item == content && [Some(kitchen.board), Some(kitchen.plate)].contains(&at),
        ItemProgress::Missing => serves(kitchen, content, needed.item),
    };
    if all().any(|(_, needed)| counts(needed)) {
        return None;
    }
    // What lies ready for an order is told rather than that another one has it.
    let is_used = |needed: &NeededItem| matches!(needed.progress, ItemProgress::Stacked | ItemProgress::Missing);
    let of_it = all().filter(|(_, needed)| serves(kitchen, content, needed.item));
    if let Some((order, needed)) = of_it.min_by_key(|(_, needed)| is_used(needed)) {
        let (order, name) = (label(kitchen, order), name(content));
        return Some(match needed.progress {
            ItemProgress::Ready(at) | ItemProgress::InWork(at) => {
                format!("{name} for {order} is there: {}", label(kitchen, at))
            }
            ItemProgress::Stacked | ItemProgress::Missing => format!("{order} has {name} already"),
        });
    }
    // Items that cannot be stacked on each other stand in each other's place.
    let forms: Vec<ContentId> = (0..kitchen.contents.len())
        .map(|index| ContentId(index as u8))
        .filter(|&to| serves(kitchen, content, to))
        .collect();
    let is_instead = |needed: &NeededItem| forms.iter().all(|&form| kitchen.stacked(needed.item, form).is_none());
    // With several orders nobody knows which of them the press was for.
    let instead = all().find(|(_, needed)| is_missing(needed) && is_instead(needed)).filter(|_| orders.len() == 1);
    Some(match instead {
        Some((order, needed)) if at.is_none() => format!("{} needs {}", label(kitchen, order), name(needed.item)),
        _ => format!("no order needs {}", name(content)),
    })
}

/// That a stack on the plate is not the whole dish yet.
fn incomplete(kitchen: &Kitchen, orders: &[OrderNeeds], held: ContentId) -> Option<String> {
    let items = &kitchen.content(held).items;
    let needs = orders.iter().find(|needs| items.len() > 1 && items.iter().all(|&item| has(needs, item)))?;
    let lacks = needs.items.iter().map(|needed| needed.item).filter(|item| !items.contains(item));
    let lacks = list(kitchen, lacks);
    (!lacks.is_empty()).then(|| format!("{} still needs {lacks}", label(kitchen, needs.order)))
}

/// Why an item is not to be made: no order has a use for it.
fn made_for_nothing(kitchen: &Kitchen, orders: &[OrderNeeds], made: ContentId) -> Option<String> {
    let is_open = |progress: ItemProgress| !matches!(progress, ItemProgress::Stacked | ItemProgress::Ready(_));
    let mut items = orders.iter().flat_map(|needs| &needs.items);
    let is_needed = items.any(|needed| is_open(needed.progress) && serves(kitchen, made, needed.item));
    (!is_needed).then(|| format!("no order needs {}", word(kitchen, made)))
}

/// Why a content does not belong on the stack: no order's recipe has these items together.
fn stacked(
    kitchen: &Kitchen,
    state: State,
    orders: &[OrderNeeds],
    board: LocationId,
    held: ContentId,
) -> Option<String> {
    let below = state.content(board);
    let stack = if below.is_empty() { held } else { kitchen.stacked(below, held)? };
    let stack = &kitchen.content(stack).items;
    if orders.iter().any(|needs| stack.iter().all(|&item| has(needs, item))) {
        return None;
    }
    // The order that the stack is nearest to; ties go to the upper one.
    let fitting = |needs: &&OrderNeeds| stack.iter().filter(|&&item| has(needs, item)).count();
    let nearest = orders.iter().rev().max_by_key(fitting).filter(|needs| fitting(needs) > 0 || orders.len() == 1);
    let put = &kitchen.content(held).items;
    let Some(nearest) = nearest else { return Some(format!("no order needs {}", word(kitchen, held))) };
    let wrong: Vec<ContentId> = put.iter().copied().filter(|&item| !has(nearest, item)).collect();
    if wrong.is_empty() {
        return Some(format!("{} fits no order with {}", word(kitchen, held), word(kitchen, below)));
    }
    Some(instead(kitchen, nearest, &wrong))
}

/// "order 1 needs shaped rice, not cooked rice": the order's items that the wrong ones could stand for, else all that
/// are missing.
fn instead(kitchen: &Kitchen, needs: &OrderNeeds, wrong: &[ContentId]) -> String {
    let of_ingredient = |item: ContentId| kitchen.content(item).ingredient;
    let open =
        || needs.items.iter().filter(|needed| needed.progress != ItemProgress::Stacked).map(|needed| needed.item);
    let alike = open().filter(|&item| wrong.iter().any(|&other| of_ingredient(other) == of_ingredient(item)));
    let alike: Vec<ContentId> = alike.collect();
    let right: Vec<ContentId> = if alike.is_empty() { open().collect() } else { alike };
    let (order, wrong) = (label(kitchen, needs.order), list(kitchen, wrong.iter().copied()));
    format!("{order} needs {}, not {wrong}", list(kitchen, right.into_iter()))
}

/// Whose dish the plate holds, or what its content lacks, or has too much, for the order.
fn not_served(kitchen: &Kitchen, state: State, orders: &[OrderNeeds], order: LocationId) -> String {
    let on_plate = &kitchen.content(state.content(kitchen.plate)).items;
    let is_whole =
        |needs: &&OrderNeeds| needs.items.len() == on_plate.len() && on_plate.iter().all(|&item| has(needs, item));
    if let Some(other) = orders.iter().find(is_whole) {
        return format!("the plate holds {}'s dish", label(kitchen, other.order));
    }
    let name = label(kitchen, order);
    let Some(needs) = orders.iter().find(|needs| needs.order == order) else {
        return format!("{name} asks for no dish");
    };
    let missing = needs.items.iter().map(|needed| needed.item).filter(|item| !on_plate.contains(item));
    let missing = list(kitchen, missing);
    let extra = list(kitchen, on_plate.iter().copied().filter(|&item| !has(needs, item)));
    match (missing.is_empty(), extra.is_empty()) {
        (_, true) => format!("{name} needs {missing}"),
        (true, false) => format!("{name} needs no {extra}"),
        (false, false) => format!("{name} needs {missing}, not {extra}"),
    }
}

/// That an order counts on what the hand holds.
fn needed_by(kitchen: &Kitchen, orders: &[OrderNeeds], hand: LocationId, held: ContentId) -> Option<String> {
    let counts_on = |needs: &&OrderNeeds| {
        let in_hand = [ItemProgress::Ready(hand), ItemProgress::InWork(hand)];
        let stack = &kitchen.content(held).items;
        let is_its_stack = stack.len() > 1 && stack.iter().all(|&item| has(needs, item));
        is_its_stack || needs.items.iter().any(|needed| in_hand.contains(&needed.progress))
    };
    let needs = orders.iter().find(counts_on)?;
    Some(format!("{} needs {}", label(kitchen, needs.order), word(kitchen, held)))
}
