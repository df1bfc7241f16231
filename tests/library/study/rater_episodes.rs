//! False belief episodes from raters' codes: each clause of the rule on logs made by hand.

use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::FalseBeliefTarget;
use tomcom_core::measures::errors::PressJudge;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::raters::{ErrorCauseCode, RaterCodes};
use tomcom_study::prevention::TrialGroundTruth;
use tomcom_study::rater_episodes::rater_episodes;
use tomcom_study::rater_episodes::{BeliefEvidence, BeliefEvidenceEvent};
use tomcom_study::rater_episodes::{KnownFalseBeliefs, RaterFalseBeliefAgreement};

use super::at;
use crate::support::*;

/// A log that is written by hand, a second from line to line.
struct Log {
    kitchen: Arc<Kitchen>,
    cost: CostToGo,
    judge: PressJudge,
    trace: BeliefEvidence,
    judged: Vec<JudgedPress>,
    coded: Vec<(u64, FalseBeliefTarget)>,
    state: State,
}

/// An episode as aspect, beginning, correction (-1: none) and errors.
type Told = (String, i32, i32, u32);

impl Log {
    fn now(&self) -> SessionTime {
        at(self.trace.events.len() as f64)
    }

    fn add(&mut self, event: BeliefEvidenceEvent) {
        let now = self.now();
        self.trace.events.push((now, event));
    }

    /// A line: "order_1 tuna maki" and "cooking_pot rice raw" are changes by others, "look plate", "tell plate"; "press cook" is a
    /// press, and "press cook: cooking_pot" one that is coded as an error about the pot.
    fn line(&mut self, line: &str) {
        let kitchen = self.kitchen.clone();
        let location = |name: &str| kitchen.location_named(name).unwrap_or_else(|| panic!("no location {name}"));
        let (verb, rest) = line.split_once(' ').unwrap_or((line, ""));
        match verb {
            "wait" => self.add(BeliefEvidenceEvent::Told { aspects: Vec::new() }),
            "look" => self.add(BeliefEvidenceEvent::Looked { location: location(rest) }),
            "tell" => {
                let mut aspects = vec![AspectId::of_location(location(rest))];
                if let OrderContent::Dish(dish) = self.state.order(location(rest)) {
                    aspects.extend(rest.starts_with("order").then(|| kitchen.aspect_of_dish(dish)));
                }
                self.add(BeliefEvidenceEvent::Told { aspects });
            }
            "press" => self.press(rest),
            place => {
                let (before, place) = (self.state, location(place));
                match kitchen.orders.contains(&place) {
                    true => self.state.set_order(place, OrderContent::Dish(kitchen.dish_named(rest).expect("a dish"))),
                    false => self.state.set_content(place, kitchen.content_named(rest).expect("a content")),
                }
                self.add(BeliefEvidenceEvent::Changed { before, after: self.state });
            }
        }
    }

    fn press(&mut self, line: &str) {
        let (name, about) = line.split_once(": ").map_or((line, None), |(name, about)| (name, Some(about)));
        let button = self.kitchen.button_named(Agent::Human, name).unwrap_or_else(|| panic!("no button {name}"));
        let press = self.kitchen.try_press(self.state, Agent::Human, button);
        let (seq, time, before) = (self.trace.events.len() as u64, self.now(), self.state);
        let verdict = self.judge.human_pressed(&mut self.cost, time, &press);
        self.judged.push(JudgedPress { seq, time, button, before, verdict, belief_known: false, cause: None });
        if let Some(about) = about {
            assert!(verdict.error, "{line} is no error: {verdict:?}");
            let target = ErrorCauseCode::Belief(about.to_string()).target(&self.kitchen, before);
            self.coded.push((seq, target.expect("a target")));
        }
        self.state = press.after;
        self.add(BeliefEvidenceEvent::Pressed { seq, press });
    }

    fn episodes(&mut self) -> Vec<Told> {
        let seconds = |time: SessionTime| time.as_secs_f64() as i32;
        let found = rater_episodes(&self.kitchen, &mut self.cost, &self.trace, &self.judged, &self.coded);
        let tell = |one: &tomcom_core::measures::sequences::FalseBeliefEpisode| {
            let name = self.kitchen.aspects[one.aspect.index()].name.clone();
            (name, seconds(one.began), one.corrected.map_or(-1, seconds), one.errors)
        };
        found.iter().map(tell).collect()
    }
}

/// The log of these lines in the sushi kitchen, which begins empty at 0 s; the first line is at 1 s.
fn log(lines: &[&str]) -> Log {
    let kitchen = kitchen("sushi");
    let state = kitchen.empty_state();
    let mut log = Log {
        cost: CostToGo::new(kitchen.clone()),
        judge: PressJudge::new(kitchen.clone()),
        trace: BeliefEvidence::default(),
        judged: Vec::new(),
        coded: Vec::new(),
        state,
        kitchen,
    };
    log.add(BeliefEvidenceEvent::Started { state });
    lines.iter().for_each(|line| log.line(line));
    log
}

fn check(lines: &[&str], wanted: &[(&str, i32, i32, u32)]) {
    let wanted: Vec<Told> =
        wanted.iter().map(|&(name, from, to, errors)| (name.to_string(), from, to, errors)).collect();
    assert_eq!(log(lines).episodes(), wanted, "{lines:#?}");
}

/// What cooks in the pot was cooked by the robot, and the participant cooks it again.
const COOKED_TWICE: &str = "press cook: cooking_pot";
const TUNA: &str = "order_1 tuna maki";

#[test]
fn a_belief_about_a_place_is_false_from_the_first_change_after_it_was_last_shown_right() {
    // Looked at after 2 s, changed at 4 s, error at 5 s, looked at again at 6 s.
    let unseen = [TUNA, "cooking_pot rice raw", "look cooking_pot", "cooking_pot rice cooked", COOKED_TWICE];
    check(&[&unseen[..], &["look cooking_pot"]].concat(), &[("cooking_pot", 4, 6, 1)]);
    // A look elsewhere mends nothing; a second error is one more of the same episode.
    check(&[&unseen[..], &["look plate", COOKED_TWICE, "look cooking_pot"]].concat(), &[("cooking_pot", 4, 8, 2)]);
    // Nothing mends it.
    check(&[&unseen[..], &["look plate"]].concat(), &[("cooking_pot", 4, -1, 1)]);
    // Never looked at: from the first change after the start.
    check(&[TUNA, "cooking_pot rice raw", "cooking_pot rice cooked", COOKED_TWICE], &[("cooking_pot", 2, -1, 1)]);
    // Told instead of looked at.
    let told =
        [TUNA, "cooking_pot rice raw", "tell cooking_pot", "cooking_pot rice cooked", COOKED_TWICE, "tell cooking_pot"];
    check(&told, &[("cooking_pot", 4, 6, 1)]);
}

#[test]
fn without_a_change_it_is_false_from_the_last_time_that_it_was_shown_right() {
    // Put in by an own press at 3 s, and taken out again.
    check(
        &[TUNA, "press take rice", "press cooking_pot", "press cooking_pot: cooking_pot"],
        &[("cooking_pot", 3, -1, 1)],
    );
    // Nothing ever happened there: from the start of the trial.
    check(&[TUNA, "press trash: counter"], &[("counter", 0, -1, 1)]);
    // An error that is coded after a press that showed it right begins another episode.
    let unseen = [TUNA, "cooking_pot rice raw", "look cooking_pot", "cooking_pot rice cooked", COOKED_TWICE];
    let again = [&unseen[..], &["press cooking_pot", COOKED_TWICE]].concat();
    check(&again, &[("cooking_pot", 4, 6, 1), ("cooking_pot", 6, -1, 1)]);
}

#[test]
fn a_look_or_signal_after_which_the_error_is_made_all_the_same_shows_nothing() {
    // Looked at after the change, before the error: false from the change all the same.
    let seen = [TUNA, "cooking_pot rice cooked", "look cooking_pot", COOKED_TWICE];
    check(&seen, &[("cooking_pot", 2, -1, 1)]);
    // Looked at and told between two errors: one episode, which the last look ends.
    let again =
        [&seen[..], &["look cooking_pot", "tell cooking_pot", COOKED_TWICE, "look cooking_pot", "look cooking_pot"]]
            .concat();
    check(&again, &[("cooking_pot", 2, 8, 2)]);
    // The change between look and error is what the error is about.
    let changed = [&seen[..], &["look cooking_pot", "cooking_pot rice shaped", "press cook: cooking_pot"]].concat();
    check(&changed, &[("cooking_pot", 2, 5, 1), ("cooking_pot", 6, -1, 1)]);
}

/// A signal that mends a false belief was sent while it was false.
#[test]
fn a_signal_that_mends_it_falls_into_the_episode() {
    let mut log = log(&[TUNA, "cooking_pot rice cooked", COOKED_TWICE, "tell cooking_pot"]);
    let found = rater_episodes(&log.kitchen, &mut log.cost, &log.trace, &log.judged, &log.coded);
    assert!(found[0].corrected.is_some_and(|end| at(4.0) < end && end < at(4.1)), "{found:?}");
}

#[test]
fn a_place_that_is_again_as_it_was_known_is_believed_right() {
    let before = [TUNA, "cooking_pot rice cooked", "look cooking_pot", "cooking_pot empty"];
    // Changed and changed back unseen, and changed once more: from the last of these.
    let back =
        [&before[..], &["cooking_pot rice cooked", "cooking_pot empty", "press cooking_pot: cooking_pot"]].concat();
    check(&back, &[("cooking_pot", 6, -1, 1)]);
    let mended = [&before[..], &["press cooking_pot: cooking_pot", "cooking_pot rice cooked"]].concat();
    check(&mended, &[("cooking_pot", 4, 6, 1)]);
}

#[test]
fn own_presses_show_what_is_believed_of_a_place() {
    let unseen = [TUNA, "cooking_pot rice raw", "look cooking_pot", "cooking_pot rice cooked", COOKED_TWICE];
    // Takes the cooked rice out of the pot: changes the place.
    check(&[&unseen[..], &["press cooking_pot"]].concat(), &[("cooking_pot", 4, 6, 1)]);
    // Takes nori into the hand, which would have been as good a press with raw rice in the pot: shows nothing.
    check(&[&unseen[..], &["press take nori"]].concat(), &[("cooking_pot", 4, -1, 1)]);
    // An error about the place shows nothing, though it changes the place.
    let taken =
        [TUNA, "cooking_pot rice cooked", "look cooking_pot", "cooking_pot rice raw", "press cooking_pot: cooking_pot"];
    check(&taken, &[("cooking_pot", 4, -1, 1)]);
}

#[test]
fn a_wrong_recipe_lasts_until_a_press_that_the_confusion_would_not_have_made() {
    // The crab for a shrimp nigiri; nori belongs to both, so its presses show nothing.
    let crab = [
        "order_1 shrimp nigiri",
        "look order_1",
        "press take nori",
        "press assembly_board",
        "press take crab: order_1",
    ];
    check(&crab, &[("recipe of shrimp nigiri", 0, -1, 1)]);
    // Who throws the crab away knows better.
    check(&[&crab[..], &["press trash"]].concat(), &[("recipe of shrimp nigiri", 0, 6, 1)]);
    // A look at the order does not tell its recipe, a signal about it does.
    let told = [&crab[..], &["look order_1", "tell order_1"]].concat();
    check(&told, &[("recipe of shrimp nigiri", 0, 7, 1)]);
    // Known right before: false from the last press that showed it.
    let known =
        ["order_1 shrimp nigiri", "look order_1", "press take shrimp", "press cooking_pot", "press take crab: order_1"];
    check(&known, &[("recipe of shrimp nigiri", 4, -1, 1)]);
}

#[test]
fn an_order_that_changed_and_was_not_looked_at_is_what_is_believed_wrong() {
    let unseen =
        ["order_1 crab maki", "look order_1", "order_1 shrimp nigiri", "press take crab: order_1", "look order_1"];
    check(&unseen, &[("order_1", 3, 5, 1)]);
    // Without any gaze nobody knows what was seen: the recipe.
    let no_gaze = ["order_1 crab maki", "order_1 shrimp nigiri", "press take crab: order_1"];
    check(&no_gaze, &[("recipe of shrimp nigiri", 0, -1, 1)]);
    // A press that brings the order nearer shows that it was seen.
    let pressed = [
        "order_1 crab maki",
        "look order_1",
        "order_1 shrimp nigiri",
        "press take shrimp",
        "press cooking_pot",
        "press take crab: order_1",
    ];
    check(&pressed, &[("recipe of shrimp nigiri", 5, -1, 1)]);
}

#[test]
fn only_what_both_raters_say_counts_and_the_rest_is_counted_beside_it() {
    let belief = |place: &str| ErrorCauseCode::Belief(place.to_string());
    let one = RaterCodes(
        [(1, belief("plate")), (2, belief("plate")), (3, belief("plate")), (4, ErrorCauseCode::Slip)].into(),
    );
    let other = RaterCodes(
        [(1, belief("plate")), (2, belief("counter")), (3, ErrorCauseCode::Race), (4, ErrorCauseCode::Slip)].into(),
    );
    let shared = RaterFalseBeliefAgreement::count(&[one.clone(), other.clone()]);
    assert_eq!((shared.same, shared.differing, shared.of_one), (1, 1, 1));
    assert_eq!(RaterFalseBeliefAgreement::count(&[other.clone(), one.clone()]), shared, "nobody is the first");
    assert_eq!(one.agreed(&other).0.into_keys().collect::<Vec<_>>(), [1, 4]);
}

#[test]
fn errors_prevented_follow_from_the_episodes_and_harmless_ones_are_not_known() {
    let mut log =
        log(&[TUNA, "cooking_pot rice raw", "look cooking_pot", "cooking_pot rice cooked", COOKED_TWICE, COOKED_TWICE]);
    let codes: RaterCodes = RaterCodes(
        log.coded.iter().map(|(seq, _)| (*seq, ErrorCauseCode::Belief("cooking_pot".to_string()))).collect(),
    );
    let (kitchen, judged) = (log.kitchen.clone(), log.judged.clone());
    let known = KnownFalseBeliefs::coded(BeliefSource::Raters, &kitchen, &mut log.cost, &log.trace, &judged, &codes);
    let truth = TrialGroundTruth::new(&kitchen, &judged, &known);
    let pot = AspectId::of_location(kitchen.location_named("cooking_pot").expect("a pot"));
    let sent = tomcom_study::prevention::HypotheticalSignal { time: at(4.5), press: 0, aspects: vec![pot] };
    let count = truth.count_signals(&[sent]);
    assert_eq!((count.related, count.prevented, count.useless, count.harmless), (2, 2, 0, None));
}
