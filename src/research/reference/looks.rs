//! What the human of each explicit belief sees: by gaze samples at locations, by looks while the gaze is unknown, and of
//! the signal on the display.

use rand::RngExt;
use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{
    Agent, AspectId, ButtonId, ContentId, DishId, Kitchen, LocationId, LocationKind, OrderContent, State,
};
use tomcom_core::mind::model::{HumanModel, PerceptionModel, PerceptionUnit};

use super::person::{Particle, pick};

/// Share of the full reading rate below which the gaze counts as being elsewhere than at a location.
const ELSEWHERE: f64 = 0.1;

/// The effect of a gaze sample at one location.
#[derive(Clone, Debug, PartialEq)]
pub struct LocationReading {
    pub location: LocationId,
    /// Whether the sample begins a new look, in which the location can be read again.
    pub begins: bool,
    /// Probability that the location is read by this sample, given that it was not yet read in this look.
    pub chance: f64,
    /// Distribution of the value that is read at the location.
    pub reading: Vec<f64>,
    /// Where the sample is an observation: `[v][o]`, the probability of observing value o where v is the true one, by
    /// which the belief is updated. Where a look is one, the belief becomes certain of what was read.
    pub observation: Option<Vec<Vec<f64>>>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Look {
    code: u8,
    last: SessionTime,
}

/// Tracks looks at locations and the recent states of the display.
#[derive(Clone, Debug, Default)]
pub struct LookTracker {
    /// Recent states of the display, each with the session time at which the state appeared.
    shown: Vec<(SessionTime, State)>,
    /// The present look at each location.
    looks: Vec<Look>,
}

impl LookTracker {
    /// Records that the display shows `state` from `now` on.
    pub fn show(&mut self, now: SessionTime, state: State) {
        self.shown.push((now, state));
    }

    /// Moves all times on by a duration for which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.shown.iter_mut().for_each(|(since, _)| *since = *since + by);
        self.looks.iter_mut().for_each(|look| look.last = look.last + by);
    }

    /// The effect at each location of a gaze sample taken at session time `taken`, during which the gaze is known for
    /// `known_s` seconds.
    pub fn glances(
        &mut self,
        kitchen: &Kitchen,
        model: &PerceptionModel,
        sample: &GazeSample,
        taken: SessionTime,
        known_s: f64,
    ) -> Vec<LocationReading> {
        let on_display = (0.0..=1.0).contains(&sample.x) && (0.0..=1.0).contains(&sample.y);
        if !on_display || known_s <= 0.0 {
            return Vec::new();
        }
        let Some(state) = self.shown_at(taken, model.history_s) else { return Vec::new() };
        let confidence = sample.confidence.min(1.0);
        self.looks.resize(kitchen.locations.len(), Look::default());
        let mut glances = Vec::new();
        for index in 0..kitchen.locations.len() {
            let location = LocationId(index as u8);
            let distance_m = kitchen.locations[index].display.distance_m([sample.x, sample.y], kitchen.display_m);
            let rate_hz = model.reading_rate().at(distance_m, confidence);
            let code = state.code(location);
            let look = &mut self.looks[index];
            let begins = code != look.code || taken.secs_since(look.last) > model.look_ends_s;
            if begins {
                *look = Look { code, ..*look };
            }
            if model.observation == PerceptionUnit::Sample {
                let Some(value) = kitchen.aspects[index].index_of(code) else { continue };
                if distance_m <= model.radius_m() && sample.confidence >= model.min_confidence {
                    let values = 0..kitchen.aspects[index].values.len();
                    let all: Vec<_> = values.map(|value| reading(kitchen, model, location, value)).collect();
                    let (reading, observation) = (all[value].clone(), Some(all));
                    glances.push(LocationReading { location, begins: true, chance: 1.0, reading, observation });
                }
                continue;
            }
            if rate_hz >= ELSEWHERE * model.reading_rate_hz * confidence {
                look.last = taken;
            }
            let Some(value) = kitchen.aspects[index].index_of(code) else { continue };
            let chance = 1.0 - (-rate_hz * known_s).exp();
            glances.push(LocationReading {
                location,
                begins,
                chance,
                reading: reading(kitchen, model, location, value),
                observation: None,
            });
        }
        glances
    }

    /// State that the display showed at `time`; `None` if that time is before the stored history.
    fn shown_at(&self, time: SessionTime, history_s: f64) -> Option<State> {
        let newest = self.shown.last().map(|(since, _)| *since)?;
        let (at, (_, state)) = self.shown.iter().enumerate().rev().find(|(_, (since, _))| *since <= time)?;
        // A state of the display is stored until its successor is older than the history.
        let is_known = self.shown.get(at + 1).is_none_or(|(until, _)| newest.secs_since(*until) <= history_s);
        is_known.then_some(*state)
    }
}

/// The probability of reading each value of a location, given its true value (a row of the confusion matrix).
pub fn reading(kitchen: &Kitchen, model: &PerceptionModel, location: LocationId, value: usize) -> Vec<f64> {
    let aspect = &kitchen.aspects[location.index()];
    let alike: Vec<bool> =
        aspect.values.iter().map(|&other| is_alike(kitchen, location, aspect.values[value], other)).collect();
    let count = alike.iter().filter(|alike| **alike).count();
    let others = aspect.values.len() - 1 - count;
    let to_alike = if count == 0 { 0.0 } else { model.look_alike };
    let to_others = if others == 0 { 0.0 } else { model.anything };
    let chance = |other: usize| match alike[other] {
        _ if other == value => 1.0 - to_alike - to_others,
        true => to_alike / count as f64,
        false => to_others / others as f64,
    };
    (0..aspect.values.len()).map(chance).collect()
}

/// Whether one code of a location looks like another one.
fn is_alike(kitchen: &Kitchen, location: LocationId, code: u8, other: u8) -> bool {
    let stack = |dish: DishId| kitchen.dish(dish).stack();
    let (one, another) = match kitchen.location(location).kind {
        LocationKind::Order => match (OrderContent::from_code(code), OrderContent::from_code(other)) {
            (OrderContent::Dish(one), OrderContent::Dish(another)) => (stack(one), stack(another)),
            _ => return false,
        },
        _ => (ContentId(code), ContentId(other)),
    };
    kitchen.content(one).look_alikes.contains(&another)
}

/// For each explicit belief, the probability that the human needs to look at each location before the next press.
#[derive(Clone, Debug)]
pub struct LookNeedProbabilities {
    needs: Vec<Vec<f64>>,
}

impl LookNeedProbabilities {
    /// Computes which locations the human of every belief needs to look at, from the press probabilities under that
    /// belief.
    pub fn before(
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &[Particle],
        cost: &mut CostToGo,
        random: &mut Stream,
    ) -> LookNeedProbabilities {
        let own_hand = kitchen.hands[Agent::Human.index()];
        let mut needs_of = |person: &Particle| {
            let chances = person.press_chances(kitchen, cost, &model.decision, model.inference.states, random);
            let mut needs = vec![0.0; kitchen.locations.len()];
            for (button, chance) in chances.iter().enumerate() {
                for place in kitchen.watched(ButtonId(button as u8)).into_iter().filter(|&place| place != own_hand) {
                    needs[place.index()] += chance;
                }
            }
            needs
        };
        LookNeedProbabilities { needs: people.iter().map(&mut needs_of).collect() }
    }

    /// Draws looks for every belief at a display that shows `state`. `looks` are the expected looks at a location: if
    /// the next press does not need the location, and if it certainly does.
    pub fn look(
        &self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        state: State,
        [least, needed]: [f64; 2],
        random: &mut Stream,
    ) {
        for (person, needs) in people.iter_mut().zip(&self.needs) {
            for (index, need) in needs.iter().enumerate() {
                let expected = least + (needed - least) * need;
                if random.random::<f64>() < 1.0 - (-expected).exp() {
                    read(kitchen, model, person, LocationId(index as u8), state, random);
                }
            }
        }
    }
}

/// Draws for every belief whether the human reads what changed between two states, with probability `seen` at each
/// location.
pub fn see_changes(
    kitchen: &Kitchen,
    model: &HumanModel,
    people: &mut [Particle],
    [before, after]: [State; 2],
    seen: f64,
    random: &mut Stream,
) {
    for index in 0..kitchen.locations.len() {
        let location = LocationId(index as u8);
        if before.code(location) == after.code(location) {
            continue;
        }
        for person in &mut *people {
            if random.random::<f64>() < seen {
                read(kitchen, model, person, location, after, random);
            }
        }
    }
}

/// Draws for every belief looks at each location of a bit set, with probability `looks`; a look reads the content that
/// the state has there.
pub fn asked(
    kitchen: &Kitchen,
    model: &HumanModel,
    people: &mut [Particle],
    (locations, state): (u32, State),
    looks: f64,
    random: &mut Stream,
) {
    for index in (0..kitchen.locations.len()).filter(|index| locations & 1 << index != 0) {
        for person in &mut *people {
            if random.random::<f64>() < looks {
                read(kitchen, model, person, LocationId(index as u8), state, random);
            }
        }
    }
}

/// Makes a belief certain of the content that is read at a location.
fn read(
    kitchen: &Kitchen,
    model: &HumanModel,
    person: &mut Particle,
    location: LocationId,
    state: State,
    random: &mut Stream,
) {
    if let Some(value) = kitchen.aspects[location.index()].index_of(state.code(location)) {
        let value = pick(&reading(kitchen, &model.perception, location, value), random);
        person.settle(AspectId::of_location(location), value);
    }
}

/// The signal on the display.
#[derive(Clone, Debug)]
struct ShownContent {
    location: LocationId,
    aspects: Vec<AspectId>,
    since: SessionTime,
    noticed: f64,
}

/// The signal on the display, if there is one.
#[derive(Clone, Debug, Default)]
pub struct ReferenceSignalHistory {
    shown: Option<ShownContent>,
}

impl ReferenceSignalHistory {
    /// A signal takes the place of the one before it.
    pub fn show(
        &mut self,
        kitchen: &Kitchen,
        model: &HumanModel,
        now: SessionTime,
        (location, aspects): (LocationId, Vec<AspectId>),
    ) {
        let noticed = match kitchen.location(location).kind {
            LocationKind::Order => model.signal.noticed,
            _ => model.signal.highlight_noticed.unwrap_or(model.signal.noticed),
        };
        self.shown = Some(ShownContent { location, aspects, since: now, noticed });
    }

    pub fn end(&mut self) {
        self.shown = None;
    }

    /// Moves the signal's beginning on by a duration for which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.shown.iter_mut().for_each(|shown| shown.since = shown.since + by);
    }

    /// Lets the human of every belief notice the signal, or not, where signals take no time to be read.
    pub fn read_at_once(
        &mut self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        state: State,
        random: &mut Stream,
    ) {
        if let Some(shown) = self.shown.take() {
            shown.read(kitchen, model, people, shown.noticed, state, random);
            people.iter_mut().for_each(|person| person.read_signal = false);
        }
    }

    /// Lets every belief read the signal in a gaze sample whose gaze is known for `known_s` seconds.
    pub fn look(
        &self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        (sample, taken, known_s): (&GazeSample, SessionTime, f64),
        state: State,
        random: &mut Stream,
    ) {
        let Some(shown) = self.shown.as_ref().filter(|shown| taken >= shown.since) else { return };
        if !(0.0..=1.0).contains(&sample.x) || !(0.0..=1.0).contains(&sample.y) {
            return;
        }
        let distance_m = kitchen.location(shown.location).display.distance_m([sample.x, sample.y], kitchen.display_m);
        let near = (-distance_m.powi(2) / (2.0 * model.perception.radius_m().powi(2))).exp();
        let rate_hz = model.signal.reading_rate_hz * near * sample.confidence.min(1.0);
        shown.read(kitchen, model, people, 1.0 - (-rate_hz * known_s).exp(), state, random);
    }

    /// Lets the human of every belief notice the signal, or not, in `seconds` of unknown gaze up to `until`.
    pub fn look_unseen(
        &self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        (seconds, until): (f64, SessionTime),
        state: State,
        random: &mut Stream,
    ) {
        let Some(shown) = &self.shown else { return };
        // Of those who notice the signal, the share that has read it t seconds after its beginning is 1 - exp(-L (1 -
        // exp(-t / delay))) for exp(-L) = 1 - noticed.
        let most = -(1.0 - shown.noticed.min(0.999)).ln();
        let hazard = |time_s: f64| most * (1.0 - (-time_s.max(0.0) / model.signal.delay_s).exp());
        let until_s = until.secs_since(shown.since);
        let passed = hazard(until_s) - hazard(until_s - seconds);
        shown.read(kitchen, model, people, 1.0 - (-passed).exp(), state, random);
    }
}

impl ShownContent {
    /// Lets the human of each belief read the signal with the probability `chance`.
    fn read(
        &self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        chance: f64,
        state: State,
        random: &mut Stream,
    ) {
        for person in people {
            if random.random::<f64>() >= chance {
                continue;
            }
            person.read_signal = true;
            for &aspect in &self.aspects {
                let values = kitchen.aspects[aspect.index()].values.len();
                let truth = kitchen.true_value(state, aspect);
                let weight = |value: usize| match value == truth {
                    true => 1.0 - model.signal.misread,
                    false => model.signal.misread / (values - 1) as f64,
                };
                let weights: Vec<f64> = (0..values).map(weight).collect();
                person.settle(aspect, pick(&weights, random));
            }
        }
    }
}
