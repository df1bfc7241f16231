//! The participant's beliefs for Rerun: the estimate of them, and for simulated participants the recorded belief.

use super::colours;
use super::entity_content::{EntityData, EntityUpdate, MarkShape, SeriesStyle, slug};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{AspectId, Kitchen, State, StateAspect};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::RecordedEstimate;
use tomcom_core::mind::{AspectBelief, RecordedBelief};
use tomcom_session::history::wording;
use tomcom_session::{Event, Session, TimestampedEvent};

/// Period of updates of the belief estimate between presses, in nanoseconds.
const EVERY_NS: u64 = 200_000_000;
/// State aspects with at least this P(truth), the estimated probability of the true value, are not listed on the page.
const KNOWN: f64 = 0.95;

/// Believed value of a state aspect with its probability.
struct Held<'a> {
    believes: &'a str,
    p_truth: f64,
}

/// State of the Rerun entities that show beliefs.
#[derive(Clone, Debug, Default)]
pub struct BeliefScene {
    /// Time of the last update of the belief estimate, in units of [`EVERY_NS`].
    tick: Option<u64>,
    page: String,
    /// For each state aspect, the falsely believed value; empty if the belief about the aspect is right.
    taken_for: Vec<String>,
}

fn estimated(aspect: &str) -> String {
    format!("human/belief/estimated/{}", slug(aspect))
}

fn held_truly(aspect: &str) -> String {
    format!("human/belief/true/{}", slug(aspect))
}

/// Path of the marks at times when the estimated belief about an aspect is false.
fn estimated_wrong(aspect: &str) -> String {
    format!("human/belief/estimated_wrong/{}", slug(aspect))
}

/// Path of the marks at times when a simulated participant's belief about an aspect is false.
fn truly_wrong(aspect: &str) -> String {
    format!("human/belief/truly_wrong/{}", slug(aspect))
}

/// Updates that add a value of P(truth) to the aspect's thin curve, and a mark if the belief is false.
fn p_truth_rows(curve: String, marks: String, p_truth: f64) -> impl Iterator<Item = EntityUpdate> {
    let mark = (p_truth < FALSE_BELOW).then(|| EntityUpdate::new(marks, EntityData::Value(p_truth)));
    std::iter::once(EntityUpdate::new(curve, EntityData::Value(p_truth))).chain(mark)
}

fn estimate_rows(aspect: &str, p_truth: f64) -> impl Iterator<Item = EntityUpdate> + use<> {
    p_truth_rows(estimated(aspect), estimated_wrong(aspect), p_truth)
}

fn wrong(aspect: &str) -> String {
    format!("human/belief/wrong/{}", slug(aspect))
}

/// Entity updates with the names and colours of the curves and marks.
pub fn fixed(kitchen: &Kitchen) -> Vec<EntityUpdate> {
    let mut rows = Vec::new();
    for (nth, aspect) in kitchen.aspects.iter().enumerate() {
        let colour = colours::of_aspect(AspectId(nth as u8));
        let name = wording::location(&aspect.name);
        // All curves are grey; marks in the aspect's colour stand out where a belief is false.
        let quiet = EntityData::QuietLine(SeriesStyle { name: name.clone(), colour: colours::QUIET });
        rows.push(EntityUpdate::new(estimated(&aspect.name), quiet.clone()));
        rows.push(EntityUpdate::new(held_truly(&aspect.name), quiet));
        let marks = |who: &str, shape| EntityData::Marks(SeriesStyle { name: format!("{name}, {who}"), colour }, shape);
        let wrong = [
            (estimated_wrong(&aspect.name), marks("wrong by the estimate", MarkShape::Circle)),
            (truly_wrong(&aspect.name), marks("truly wrong", MarkShape::Diamond)),
        ];
        rows.extend(wrong.map(|(entity, marks)| EntityUpdate::new(entity, marks)));
    }
    rows
}

impl BeliefScene {
    /// Whether an update of the belief estimate is due.
    pub fn is_due(&self, now: SessionTime) -> bool {
        self.tick.is_none_or(|last| last < now.0 / EVERY_NS)
    }

    /// Entity updates from an event that has just been applied to the session; `belief` is the estimate after the
    /// event.
    pub fn follow(
        &mut self,
        session: &Session,
        stamped: &TimestampedEvent,
        belief: Option<&DirichletBelief>,
    ) -> Vec<EntityUpdate> {
        match &stamped.event {
            Event::ParticipantBelieves(witness) => truly(witness),
            Event::BeliefEstimated(witness) => self.before_press(session, witness),
            _ => belief.map_or_else(Vec::new, |belief| self.between(session, stamped.time, belief)),
        }
    }

    fn before_press(&mut self, session: &Session, witness: &RecordedEstimate) -> Vec<EntityUpdate> {
        let aspects = || witness.aspects.iter();
        let mut rows: Vec<EntityUpdate> =
            aspects().flat_map(|told| estimate_rows(&told.aspect, told.p_truth)).collect();
        let held: Vec<Held> = aspects()
            .map(|told| Held { believes: session.kitchen.worded(&told.believes), p_truth: told.p_truth })
            .collect();
        if held.len() == session.kitchen.aspects.len() {
            rows.extend(self.in_words(session, &held));
        }
        rows
    }

    fn between(&mut self, session: &Session, now: SessionTime, belief: &DirichletBelief) -> Vec<EntityUpdate> {
        if !self.is_due(now) {
            return Vec::new();
        }
        self.tick = Some(now.0 / EVERY_NS);
        let kitchen = &session.kitchen;
        let p_truth = |index: usize| belief.p_truth(kitchen, session.state, AspectId(index as u8));
        let held: Vec<Held> = (0..kitchen.aspects.len())
            .map(|index| {
                let believes = &kitchen.aspects[index].wordings[belief.aspects[index].most_likely()];
                Held { believes, p_truth: p_truth(index) }
            })
            .collect();
        let value = |(aspect, held): (&StateAspect, &Held)| estimate_rows(&aspect.name, held.p_truth);
        let mut rows: Vec<EntityUpdate> = kitchen.aspects.iter().zip(&held).flat_map(value).collect();
        rows.extend(self.in_words(session, &held));
        rows
    }

    /// Entity updates of the page of beliefs and of the lanes whose text has changed.
    fn in_words(&mut self, session: &Session, held: &[Held]) -> Vec<EntityUpdate> {
        let kitchen = &session.kitchen;
        let mut rows = Vec::new();
        self.taken_for.resize(held.len(), String::new());
        for (index, taken_for) in self.taken_for.iter_mut().enumerate() {
            let (aspect, is_wrong) = (&kitchen.aspects[index], held[index].p_truth < FALSE_BELOW);
            let now_taken_for = if is_wrong { taken_for_what(session, index, &held[index]) } else { "" };
            if now_taken_for != taken_for {
                *taken_for = now_taken_for.to_string();
                rows.push(EntityUpdate::new(wrong(&aspect.name), EntityData::State(taken_for.clone())));
            }
        }
        let page = page(session, held);
        if page != self.page {
            self.page.clone_from(&page);
            rows.push(EntityUpdate::new("human/belief/page", EntityData::Page(page)));
        }
        rows
    }
}

/// Entity updates from the recorded belief of a simulated participant.
fn truly(witness: &RecordedBelief) -> Vec<EntityUpdate> {
    let rows = |told: &AspectBelief| p_truth_rows(held_truly(&told.aspect), truly_wrong(&told.aspect), told.p_truth);
    witness.aspects.iter().flat_map(rows).collect()
}

/// A page in Markdown with the false beliefs (lowest P(truth) first) and the uncertain beliefs.
fn page(session: &Session, held: &[Held]) -> String {
    let kitchen = &session.kitchen;
    let mut doubtful: Vec<usize> = (0..held.len()).filter(|&index| held[index].p_truth < KNOWN).collect();
    doubtful.sort_by(|&a, &b| held[a].p_truth.total_cmp(&held[b].p_truth));
    let wrong = doubtful.iter().filter(|&&index| held[index].p_truth < FALSE_BELOW);
    let unsure = doubtful.iter().filter(|&&index| held[index].p_truth >= FALSE_BELOW);
    let name = |index: usize| wording::location(&kitchen.aspects[index].name);
    let percent = |index: usize| (held[index].p_truth * 100.0).round();
    let line = |&index: &usize| {
        let (believes, truth) = (taken_for_what(session, index, &held[index]), truth(kitchen, session.state, index));
        format!("| **{}** | **{believes}** | {truth} | {} % |\n", name(index), percent(index))
    };
    let lines: String = wrong.map(line).collect();
    let mut text = match lines.is_empty() {
        true => "Nothing is believed wrong.\n".to_string(),
        false => format!("| believed wrong | taken for | truly | P(truth), estimate |\n|:--|:--|:--|--:|\n{lines}"),
    };
    let unsure: Vec<String> = unsure.map(|&index| format!("{} {} %", name(index), percent(index))).collect();
    let less = format!("below {:.0} %", KNOWN * 100.0);
    match unsure.is_empty() {
        true => text.push_str(&format!("\nNothing else has an estimated P(truth) {less}.\n")),
        false => text.push_str(&format!("\nRight, but with an estimated P(truth) {less}: {}.\n", unsure.join(", "))),
    }
    text
}

/// The falsely believed value of a state aspect, as its lane shows it.
fn taken_for_what<'a>(session: &Session, aspect: usize, held: &Held<'a>) -> &'a str {
    if held.believes == truth(&session.kitchen, session.state, aspect) { "not sure" } else { held.believes }
}

fn truth(kitchen: &Kitchen, state: State, aspect: usize) -> &str {
    &kitchen.aspects[aspect].wordings[kitchen.true_value(state, AspectId(aspect as u8))]
}
