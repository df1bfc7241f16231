//! Where the participant looks, place by place: a row of bars, a line of the list before each press, and the page's words.

use std::collections::VecDeque;

use super::entity_content::{self, EntityData, EntityUpdate, SceneColour, SceneLogLevel};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::MIN_CONFIDENCE;
use tomcom_core::kitchen::LocationId;
use tomcom_session::{Event, Session};

/// Path of the lane with the places that the participant looks at.
pub const LOOKS: &str = "look";
/// Number of past looks that the page tells.
const PAST: usize = 4;
/// Shortest look that is told in words, in seconds: at the edge of a place samples lie on both sides.
const LEAST_S: f64 = 0.1;

/// What the newest gaze sample lies on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum LookedAt {
    #[default]
    Nothing,
    Place(LocationId),
    /// Its index among the kitchen's storages.
    Storage(usize),
    Between,
    Beside,
    Uncertain,
    Lost,
}

impl LookedAt {
    fn now(session: &Session) -> LookedAt {
        let (gaze, kitchen) = (&session.gaze, &session.kitchen);
        if gaze.samples == 0 || session.is_frozen() || session.is_trial_over() {
            return LookedAt::Nothing;
        }
        if session.gaze_hz(session.time).is_none() {
            return LookedAt::Lost;
        }
        if let Some(unusable) = gaze.latest_unusable {
            return if unusable.confidence < MIN_CONFIDENCE { LookedAt::Uncertain } else { LookedAt::Beside };
        }
        let storage = gaze.last.and_then(|(_, sample)| {
            let is_there = |area: tomcom_core::kitchen::DisplayArea| {
                area.distance_m([sample.x, sample.y], kitchen.display_m) == 0.0
            };
            kitchen.storages.iter().position(|storage| is_there(storage.display))
        });
        match (session.looked_at(), storage) {
            (Some(place), _) => LookedAt::Place(place),
            (None, Some(storage)) => LookedAt::Storage(storage),
            (None, None) => LookedAt::Between,
        }
    }

    fn words(self, session: &Session) -> String {
        match self {
            LookedAt::Nothing => String::new(),
            LookedAt::Place(place) => session.kitchen.location(place).label(),
            LookedAt::Storage(index) => format!("storage: {}", session.kitchen.storages[index].label),
            LookedAt::Between => "between places".to_string(),
            LookedAt::Beside => "beside the display".to_string(),
            LookedAt::Uncertain => "gaze uncertain".to_string(),
            LookedAt::Lost => "gaze lost".to_string(),
        }
    }

    fn is_place(self) -> bool {
        matches!(self, LookedAt::Place(_) | LookedAt::Storage(_))
    }

    fn colour(self) -> SceneColour {
        if self.is_place() { entity_content::GAZE } else { entity_content::QUIET }
    }
}

/// The participant's looks so far.
#[derive(Clone, Debug, Default)]
pub struct LookScene {
    at: LookedAt,
    since: SessionTime,
    /// The last looks at places, the newest first, with their durations in seconds.
    past: VecDeque<(LookedAt, f64)>,
    /// The looks at places since the human's last press, in their order.
    since_press: Vec<(LookedAt, f64)>,
}

impl LookScene {
    /// Entity updates after an event that was just applied.
    pub fn follow(&mut self, session: &Session, event: &Event) -> Vec<EntityUpdate> {
        let at = LookedAt::now(session);
        let is_late = matches!(event, Event::Gaze(_)) && session.gaze.fault.is_some();
        if at == self.at || is_late {
            return Vec::new();
        }
        self.close(session);
        self.at = at;
        // The bar of what is between places is a gap.
        let words = if at == LookedAt::Between { String::new() } else { at.words(session) };
        vec![EntityUpdate::new(LOOKS, EntityData::State(words, at.colour()))]
    }

    /// Ends the present look, and begins it anew.
    fn close(&mut self, session: &Session) {
        let lasted_s = session.time.secs_since(std::mem::replace(&mut self.since, session.time));
        if self.at.is_place() && lasted_s >= LEAST_S {
            self.past.push_front((self.at, lasted_s));
            self.past.truncate(PAST);
            self.since_press.push((self.at, lasted_s));
        }
    }

    /// The line of the list before a press of the human: where the human looked since the press before it.
    pub fn pressed(&mut self, session: &Session) -> Option<EntityUpdate> {
        let open = (self.at, session.time.secs_since(self.since));
        let mut looks = std::mem::take(&mut self.since_press);
        looks.extend(Some(open).filter(|(at, lasted_s)| at.is_place() && *lasted_s >= LEAST_S));
        let text = format!("human looked at: {}", told(session, looks.iter()));
        let (level, colour) = (SceneLogLevel::Info, entity_content::QUIET);
        (!looks.is_empty()).then(|| EntityUpdate::new("human/looks", EntityData::Words { level, text, colour }))
    }

    /// "order 1; before: nori 0.4 s, cutting board 0.3 s".
    pub fn words(&self, session: &Session) -> String {
        let now = match self.at {
            LookedAt::Nothing => "not known".to_string(),
            at => at.words(session),
        };
        match self.past.is_empty() {
            true => now,
            false => format!("{now}; before: {}", told(session, self.past.iter())),
        }
    }
}

/// Looks at one place that follow each other are one.
fn told<'a>(session: &Session, looks: impl Iterator<Item = &'a (LookedAt, f64)>) -> String {
    let mut joined: Vec<(LookedAt, f64)> = Vec::new();
    for &(at, lasted_s) in looks {
        match joined.last_mut().filter(|last| last.0 == at) {
            Some(last) => last.1 += lasted_s,
            None => joined.push((at, lasted_s)),
        }
    }
    let told = joined.iter().map(|(at, lasted_s)| format!("{} {lasted_s:.1} s", at.words(session)));
    told.collect::<Vec<_>>().join(", ")
}
