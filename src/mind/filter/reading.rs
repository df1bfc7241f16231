//! Reading: what a gaze sample tells the human, in closed form.
//!
//! A sample that covers dt reads a location with probability 1 - exp(-rate dt), at a rate that falls with the distance of
//! the gaze from its area (see [`PerceptionModel`]). One look gives one draw from the confusion matrix: who has read the
//! location in this look does not read it again. Of the belief m0 from when the look began (or from the last event that
//! changed the belief, when a share `unread` had not read it yet), 1 - unread (1 - survived) is left, where `survived` is the
//! probability of not having read it since; all else is what was read. So a sample takes a further share of m0 to what is
//! read, and mean and second moment are exact, without samples.

use std::collections::VecDeque;

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{AspectId, ContentId, DishId, Kitchen, LocationId, LocationKind, OrderContent, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::model::{PerceptionModel, ReadingRate};

/// Where reading is slower than this share of the full rate, the gaze is elsewhere.
const ELSEWHERE: f64 = 0.1;
/// Less likely readings are left out.
const NEGLIGIBLE: f64 = 1e-9;

/// A look at a location.
#[derive(Clone, Copy, Debug)]
struct Look {
    /// The share that had not read it at the last event.
    unread: f64,
    /// The probability of not having read it since then.
    survived: f64,
    /// The code that the display showed when it was last looked at.
    code: u8,
    /// When the gaze was last there.
    last: SessionTime,
}

impl Look {
    /// The location is read with this probability by who has not read it yet: the share of the present belief that is
    /// replaced by what is read.
    fn read(&mut self, chance: f64) -> f64 {
        let left = 1.0 - self.unread * (1.0 - self.survived);
        self.survived *= 1.0 - chance;
        1.0 - (1.0 - self.unread * (1.0 - self.survived)) / left.max(f64::MIN_POSITIVE)
    }
}

/// Reads gaze samples.
#[derive(Clone, Debug)]
pub struct Reader {
    /// By location and value of its aspect, the chance that each value is read.
    confusions: Vec<Vec<Vec<f64>>>,
    rate: ReadingRate,
    looks: Vec<Look>,
    /// What the display showed, and since when.
    shown: VecDeque<(SessionTime, State)>,
    /// When the last sample was taken, usable or not.
    last: Option<SessionTime>,
}

impl Reader {
    pub fn new(kitchen: &Kitchen, model: &PerceptionModel) -> Reader {
        let of_location = |index: usize| {
            let values = kitchen.aspects[index].values.len();
            (0..values).map(|value| confusion(kitchen, model, LocationId(index as u8), value)).collect()
        };
        let confusions: Vec<_> = (0..kitchen.locations.len()).map(of_location).collect();
        let looks = vec![Look { unread: 1.0, survived: 1.0, code: 0, last: SessionTime::ZERO }; confusions.len()];
        Reader { confusions, rate: model.reading_rate(), looks, shown: VecDeque::new(), last: None }
    }

    /// The display shows this from now on.
    pub fn show(&mut self, now: SessionTime, state: State, history_s: f64) {
        self.shown.push_back((now, state));
        while self.shown.len() > 1 && now.secs_since(self.shown[1].0) > history_s {
            self.shown.pop_front();
        }
    }

    /// The belief was changed by something else than reading: who has read and who has not is no longer told apart by it.
    pub fn settle(&mut self) {
        for look in &mut self.looks {
            look.unread *= look.survived;
            look.survived = 1.0;
        }
    }

    /// Time stood still: the next sample begins anew.
    pub fn rest(&mut self) {
        self.last = None;
    }

    /// What the display showed at a time; nothing if that is too long ago.
    fn shown_at(&self, time: SessionTime) -> Option<State> {
        self.shown.iter().rev().find(|(since, _)| *since <= time).map(|(_, state)| *state)
    }

    /// Updates the belief with a sample that was taken at this time.
    pub fn read(
        &mut self,
        kitchen: &Kitchen,
        model: &PerceptionModel,
        belief: &mut DirichletBelief,
        sample: &GazeSample,
        taken: SessionTime,
    ) {
        let covers_s = self.last.map_or(model.max_sample_s, |last| taken.secs_since(last)).min(model.max_sample_s);
        self.last = Some(self.last.map_or(taken, |last| last.max(taken)));
        let on_display = (0.0..=1.0).contains(&sample.x) && (0.0..=1.0).contains(&sample.y);
        // What is not a number fails these comparisons.
        let is_usable = on_display && sample.confidence >= model.min_confidence && covers_s > 0.0;
        let Some(state) = self.shown_at(taken).filter(|_| is_usable) else { return };
        let (full_hz, confidence) = (model.reading_rate_hz, sample.confidence.min(1.0));
        for (index, look) in self.looks.iter_mut().enumerate() {
            let distance_m = kitchen.locations[index].display.distance_m([sample.x, sample.y], kitchen.display_m);
            let rate_hz = self.rate.at(distance_m, confidence);
            let code = state.code(LocationId(index as u8));
            if code != look.code || taken.secs_since(look.last) > model.look_ends_s {
                (look.unread, look.survived) = (1.0, 1.0);
                look.code = code;
            }
            if rate_hz >= ELSEWHERE * full_hz * confidence {
                look.last = taken;
            }
            let read = look.read(-(-rate_hz * covers_s).exp_m1());
            if read < NEGLIGIBLE {
                continue;
            }
            let aspect = AspectId(index as u8);
            let Some(value) = kitchen.aspects[index].index_of(code) else { continue };
            belief.aspects[aspect.index()].learn(read, self.confusions[index][value].iter().copied());
        }
    }
}

/// The chances of what is read where this value is: its own, each look-alike, and each other one.
fn confusion(kitchen: &Kitchen, model: &PerceptionModel, location: LocationId, value: usize) -> Vec<f64> {
    let aspect = &kitchen.aspects[location.index()];
    let alike: Vec<usize> = look_alike_codes(kitchen, location, aspect.values[value])
        .into_iter()
        .filter_map(|code| aspect.index_of(code))
        .collect();
    let others = aspect.values.len() - 1 - alike.len();
    let to_alike = if alike.is_empty() { 0.0 } else { model.look_alike };
    let to_others = if others == 0 { 0.0 } else { model.anything };
    let each_alike = to_alike / alike.len().max(1) as f64;
    let each_other = to_others / others.max(1) as f64;
    let chance = |other: usize| match other {
        _ if other == value => 1.0 - to_alike - to_others,
        _ if alike.contains(&other) => each_alike,
        _ => each_other,
    };
    (0..aspect.values.len()).map(chance).collect()
}

/// The codes of what a content, or an order's dish, may be taken for.
fn look_alike_codes(kitchen: &Kitchen, location: LocationId, code: u8) -> Vec<u8> {
    if kitchen.location(location).kind != LocationKind::Order {
        return kitchen.content(ContentId(code)).look_alikes.iter().map(|alike| alike.0).collect();
    }
    let OrderContent::Dish(dish) = OrderContent::from_code(code) else { return Vec::new() };
    let alike = &kitchen.content(kitchen.dish(dish).stack()).look_alikes;
    let dishes = kitchen.dishes.iter().enumerate().filter(|(_, other)| alike.contains(&other.stack()));
    dishes.map(|(index, _)| OrderContent::Dish(DishId(index as u8)).code()).collect()
}
