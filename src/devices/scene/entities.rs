//! Entities of the kitchen's places, of beliefs, and of freeze probes.

use super::entity_content::{
    self, EntityData, EntityUpdate, MarkShape, SceneArea, SceneColour, SceneDisc, SceneLogLevel, SeriesStyle, slug,
};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE};
use tomcom_core::kitchen::{
    self, Agent, AspectId, ContentId, IngredientStorage, Kitchen, Location, LocationId, LocationKind, OrderContent,
    State, StateAspect,
};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::mind::RecordedEstimate;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::{AspectBelief, RecordedBelief};
use tomcom_session::history::wording;
use tomcom_session::probes::{ProbeEvent, ProbeQuestion, ProbeSubject};
use tomcom_session::{Event, Session, TimestampedEvent, probe_sampling, proposals};

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
pub fn fixed_beliefs(kitchen: &Kitchen) -> Vec<EntityUpdate> {
    let mut rows = Vec::new();
    for (nth, aspect) in kitchen.aspects.iter().enumerate() {
        let colour = entity_content::of_aspect(AspectId(nth as u8));
        let name = wording::location(&aspect.name);
        // All curves are grey; marks in the aspect's colour stand out where a belief is false.
        let quiet = EntityData::QuietLine(SeriesStyle { name: name.clone(), colour: entity_content::QUIET });
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

/// Half widths of the outlines in the kitchen, in millimetres.
const THIN: f64 = 2.0;
const THICK: f64 = 6.0;
/// Distance of a label's anchor above the edge of its location, in millimetres; Rerun draws text below its anchor.
const ABOVE_MM: f64 = 52.0;

const MM: f64 = 1000.0;

fn area(kitchen: &Kitchen, on: kitchen::DisplayArea, colour: SceneColour) -> SceneArea {
    let [width_mm, height_mm] = kitchen.display_m.map(|length| length * MM);
    SceneArea {
        left: on.x * width_mm,
        top: on.y * height_mm,
        width: on.w * width_mm,
        height: on.h * height_mm,
        colour,
        line: THIN,
    }
}

fn words_at(at: [f64; 2], words: &str, colour: SceneColour) -> SceneDisc {
    SceneDisc { at, radius: 0.0, words: words.to_string(), colour }
}

/// Entity updates with the display's edge, the names of the locations, and the storages.
pub fn fixed_places(kitchen: &Kitchen) -> Vec<EntityUpdate> {
    let whole = kitchen::DisplayArea { x: 0.0, y: 0.0, w: 1.0, h: 1.0 };
    let name = |(index, location): (usize, &Location)| {
        // The name has the colour of the location's curves, since the plots have no legend.
        let colour = entity_content::of_aspect(AspectId::of_location(LocationId(index as u8)));
        let SceneArea { left, top, width, .. } = area(kitchen, location.display, colour);
        words_at([left + width / 2.0, top - ABOVE_MM], &location.label(), colour)
    };
    let mut rows = vec![
        EntityUpdate::new("kitchen/display", EntityData::Areas(vec![area(kitchen, whole, entity_content::FRAME)])),
        EntityUpdate::new("kitchen/names", EntityData::Discs(kitchen.locations.iter().enumerate().map(name).collect())),
    ];
    for agent in Agent::BOTH {
        let own = || kitchen.storages.iter().filter(|storage| storage.agent == agent);
        let entity = format!("kitchen/storage/{}", agent.name());
        let areas = own().map(|storage| area(kitchen, storage.display, dimmed(entity_content::agent_colour(agent))));
        rows.push(EntityUpdate::new(&entity, EntityData::Areas(areas.collect())));
        rows.push(EntityUpdate::new(
            format!("{entity}/items"),
            EntityData::Discs(own().flat_map(|storage| stored(kitchen, storage)).collect()),
        ));
    }
    rows
}

fn dimmed([red, green, blue, opacity]: SceneColour) -> SceneColour {
    [red / 2, green / 2, blue / 2, opacity]
}

/// Entity updates with the contents of the locations that differ from the state `before`, or of all locations without
/// `before`.
pub fn contents(kitchen: &Kitchen, before: Option<State>, state: State) -> impl Iterator<Item = EntityUpdate> {
    let locations = (0..kitchen.locations.len()).map(|index| LocationId(index as u8));
    let changed = locations.filter(move |&id| before.is_none_or(|before| before.code(id) != state.code(id)));
    changed.flat_map(move |id| {
        let location = kitchen.location(id);
        let items = items(kitchen, state, id);
        let is_order = location.kind == LocationKind::Order;
        let words = if items.is_empty() && !is_order { "" } else { kitchen.content_label(state, id) };
        let colour = match (items.is_empty(), location.kind) {
            (true, _) => entity_content::EMPTY,
            (false, LocationKind::Hand(agent)) => entity_content::agent_colour(agent),
            (false, _) => entity_content::FULL,
        };
        let entity = format!("kitchen/{}", slug(&location.name));
        let discs = content(kitchen, location.display, &items, words, colour);
        [
            EntityUpdate::new(&entity, EntityData::Areas(vec![area(kitchen, location.display, colour)])),
            EntityUpdate::new(format!("{entity}/items"), EntityData::Discs(discs)),
        ]
    })
}

/// Ingredient items at a location; for an order location, the items of the order's dish.
fn items(kitchen: &Kitchen, state: State, id: LocationId) -> Vec<ContentId> {
    let content = match kitchen.location(id).kind {
        LocationKind::Order => match state.order(id) {
            OrderContent::Dish(dish) => kitchen.dish(dish).stack(),
            OrderContent::None | OrderContent::Served => ContentId::EMPTY,
        },
        _ => state.content(id),
    };
    if content.is_empty() { Vec::new() } else { kitchen.content(content).items.clone() }
}

/// A disc for each item of a content, side by side in an area, with a label below.
fn content(
    kitchen: &Kitchen,
    on: kitchen::DisplayArea,
    items: &[ContentId],
    words: &str,
    colour: SceneColour,
) -> Vec<SceneDisc> {
    let SceneArea { left, top, width, height, .. } = area(kitchen, on, colour);
    let share = width / (items.len() as f64 + 1.0);
    let radius = (height * 0.34).min(share * 0.6);
    let disc = |(nth, &item): (usize, &ContentId)| SceneDisc {
        at: [left + share * (nth as f64 + 1.0), top + height / 2.0],
        radius,
        words: String::new(),
        colour: entity_content::of_item(kitchen, item),
    };
    let below = words_at([left + width / 2.0, top + height], words, colour);
    items.iter().enumerate().map(disc).chain((!words.is_empty()).then_some(below)).collect()
}

/// Discs for a storage: its item above its name, both inside its area, since storages are adjacent.
fn stored(kitchen: &Kitchen, storage: &IngredientStorage) -> [SceneDisc; 2] {
    let SceneArea { left, top, width, height, .. } = area(kitchen, storage.display, entity_content::QUIET);
    let middle = left + width / 2.0;
    let disc = SceneDisc {
        at: [middle, top + height * 0.26],
        radius: (height * 0.2).min(width * 0.3),
        words: String::new(),
        colour: entity_content::of_item(kitchen, storage.item),
    };
    [disc, words_at([middle, top + height * 0.42], &storage.label, entity_content::QUIET)]
}

/// Entities for the present signal: a highlighted location, a recipe at its order, or proposed presses in the middle of
/// the display.
pub fn shown_signal(session: &Session) -> Vec<EntityUpdate> {
    let outline = |areas| EntityUpdate::new("kitchen/shown", EntityData::Areas(areas));
    let label = |words| EntityUpdate::new("kitchen/shown/words", EntityData::Discs(words));
    if let Some(left) = proposals::left(session) {
        let middle = session.kitchen.display_m.map(|length| length * MM / 2.0);
        let words = format!("next: {}", wording::proposal(left));
        return vec![outline(Vec::new()), label(vec![words_at(middle, &words, entity_content::SIGNAL)])];
    }
    let shown = session.shown.as_ref().and_then(|shown| Some((&shown.signal, shown.location?)));
    let Some((signal, location)) = shown else { return vec![outline(Vec::new()), label(Vec::new())] };
    let words = match signal {
        Signal::ShowRecipe(_) => {
            wording::recipe(session, location).map_or_else(String::new, |recipe| format!("recipe: {recipe}"))
        }
        Signal::Highlight(_) | Signal::Propose(_) => "look here".to_string(),
    };
    let inner = area(&session.kitchen, session.kitchen.location(location).display, entity_content::SIGNAL);
    let (gap, line) = (4.0 * THIN, THICK);
    let outer = SceneArea {
        left: inner.left - gap,
        top: inner.top - gap,
        width: inner.width + 2.0 * gap,
        height: inner.height + 2.0 * gap,
        line,
        ..inner
    };
    let below = [outer.left + outer.width / 2.0, outer.top + outer.height + ABOVE_MM];
    vec![outline(vec![outer]), label(vec![words_at(below, &words, entity_content::SIGNAL)])]
}

/// Entity update with the gaze point, and with the area around the point that the participant can read.
pub fn gaze(session: &Session, sample: GazeSample) -> EntityUpdate {
    let [width_m, height_m] = session.kitchen.display_m;
    let at = [sample.x * width_m * MM, sample.y * height_m * MM];
    let around = session.spec.human.perception.radius_m() * MM;
    let colour = if sample.confidence >= MIN_CONFIDENCE { entity_content::SIGNAL } else { entity_content::LOST };
    EntityUpdate::new("human/gaze", EntityData::Sight { at, around, colour })
}

/// Path of the lane with the question that is being asked.
const ASKED: &str = "human/probes/asked";
/// Path of the text log of the participant's answers.
const SAID: &str = "human/answers";

/// State of the lanes that show freeze probes.
#[derive(Clone, Debug, Default)]
pub struct ProbeScene {
    /// Lanes that contain text. Answers stay in their lanes until the next probe begins, since the trial's clock stands
    /// still during a probe.
    filled: Vec<String>,
}

impl ProbeScene {
    /// Entity updates from an event that has just been applied to the session; `belief` is the estimate after the
    /// event.
    pub fn follow(
        &mut self,
        session: &Session,
        event: &ProbeEvent,
        belief: Option<&DirichletBelief>,
    ) -> Vec<EntityUpdate> {
        let question = |number: u32| {
            let open = session.probes.open.as_ref()?;
            open.questions.get((number as usize).checked_sub(1)?)
        };
        match event {
            ProbeEvent::Begun { .. } => self.filled.drain(..).map(|lane| state(lane, "")).collect(),
            ProbeEvent::Asked { question: number, .. } => {
                let asked = question(*number).map_or_else(String::new, |asked| wording::probe_subject(&asked.about));
                vec![state(ASKED, asked)]
            }
            ProbeEvent::Answered { question: number, answer, .. } => {
                let Some(asked) = question(*number) else { return Vec::new() };
                self.answered(session, asked, answer.as_deref(), belief)
            }
            ProbeEvent::Closed { .. } => vec![state(ASKED, "")],
            _ => Vec::new(),
        }
    }

    fn answered(
        &mut self,
        session: &Session,
        asked: &ProbeQuestion,
        answer: Option<&str>,
        belief: Option<&DirichletBelief>,
    ) -> Vec<EntityUpdate> {
        let about = wording::probe_subject(&asked.about);
        let said = match (answer, &asked.about) {
            (None, _) => "does not know".to_string(),
            (Some(name), ProbeSubject::Location { .. } | ProbeSubject::Recipe { .. }) => {
                session.kitchen.worded(name).to_string()
            }
            (Some(name), ProbeSubject::NextOrder | ProbeSubject::NextPress) => wording::location(name),
        };
        let estimate = probe_sampling::aspect(&session.kitchen, &asked.about).zip(belief).map(|(aspect, belief)| {
            let (held, values) = (&belief.aspects[aspect.index()], &session.kitchen.aspects[aspect.index()]);
            let value = held.most_likely();
            format!("{} {:.0} %", values.wordings[value], 100.0 * held.mean()[value])
        });
        let beside = estimate.as_ref().map_or_else(String::new, |estimate| format!(" (estimate: {estimate})"));
        let text = format!("human answers, {about}: {said}{beside}");
        let line =
            EntityData::Words { level: SceneLogLevel::Info, text, colour: entity_content::agent_colour(Agent::Human) };
        let lane = |kind: &str| format!("human/probes/{}_{kind}", slug(&about));
        let mut rows = vec![EntityUpdate::new(SAID, line)];
        for (kind, text) in [("answer", Some(said)), ("estimate", estimate)] {
            if let Some(text) = text {
                self.filled.push(lane(kind));
                rows.push(state(lane(kind), text));
            }
        }
        rows
    }
}

fn state(entity: impl Into<String>, text: impl Into<String>) -> EntityUpdate {
    EntityUpdate::new(entity, EntityData::State(text.into()))
}
