//! One simulated participant: its eyes, its memory, its beliefs, and what it makes of signals.

use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE, nearest_location};
use tomcom_core::kitchen::{Agent, AspectId, ButtonId, Kitchen, LocationId, OrderContent, Press, State};
use tomcom_core::mind::{PressOrigin, RecordedBelief};
use tomcom_people::participant::population::{Experience, Population, TraitSpread};
use tomcom_people::participant::{ParticipantAction, SimulatedParticipant};

use crate::files::kitchen;

/// A participant before a kitchen that nobody else changes.
pub struct Bench {
    pub kitchen: Arc<Kitchen>,
    pub state: State,
    pub now: SessionTime,
    pub one: SimulatedParticipant,
    samples: Vec<GazeSample>,
    pub presses: Vec<(f64, ButtonId)>,
    pub reasons: Vec<RecordedBelief>,
}

impl Bench {
    pub fn new(population: &Population, seed: u64) -> Bench {
        let kitchen = kitchen("sushi");
        let state = kitchen.empty_state();
        let mut one = SimulatedParticipant::new(kitchen.clone(), population, seed, 0, 0, Experience::default());
        assert_eq!(one.next_due(), None, "nothing before the trial");
        one.on_trial_start(SessionTime::ZERO, state);
        Bench {
            kitchen,
            state,
            now: SessionTime::ZERO,
            one,
            samples: Vec::new(),
            presses: Vec::new(),
            reasons: Vec::new(),
        }
    }

    pub fn location(&self, name: &str) -> LocationId {
        self.kitchen.location_named(name).expect("a location")
    }

    pub fn put(&mut self, location: &str, content: &str) {
        let content = self.kitchen.content_named(content).expect("a content");
        self.state.set_content(self.location(location), content);
    }

    pub fn order(&mut self, location: &str, dish: &str) {
        let dish = self.kitchen.dish_named(dish).expect("a dish");
        self.state.set_order(self.location(location), OrderContent::Dish(dish));
    }

    /// What it gives to the truth about an aspect.
    pub fn p_truth(&self, aspect: &str) -> f64 {
        let aspect = self.kitchen.aspect_named(aspect).expect("an aspect");
        self.one.beliefs().p_truth(&self.kitchen, self.state, aspect)
    }

    /// Shows the recipe of the first order.
    pub fn show_recipe(&mut self) {
        let order = self.location("order_1");
        self.one.on_signal(self.now, Some(order), &Signal::ShowRecipe("order_1".to_string()));
    }

    /// Whether the recipe of the tuna nigiri, which the first order wants, is believed soon after it was shown.
    pub fn knows_when_shown(&mut self) -> bool {
        self.show_recipe();
        self.pass(1.6);
        self.p_truth("recipe of tuna nigiri") > 0.9
    }

    pub fn highlight(&mut self, location: &str) {
        let place = self.location(location);
        self.one.on_signal(self.now, Some(place), &Signal::Highlight(location.to_string()));
    }

    /// A press that left the kitchen as it is now.
    fn press(&self, agent: Agent, button: ButtonId, effective: bool) -> Press {
        Press { agent, button, before: self.state, after: self.state, effective }
    }

    /// Lets so much time pass; presses have their effect.
    pub fn pass(&mut self, seconds: f64) {
        let end = self.now + SessionTime::from_secs_f64(seconds);
        while let Some(due) = self.one.next_due().filter(|&due| due <= end) {
            assert!(due >= self.now, "time runs forwards");
            self.now = due;
            match self.one.act(due, self.state) {
                Some(ParticipantAction::Gaze(sample)) => self.samples.push(sample),
                Some(ParticipantAction::Press { button, belief }) => {
                    assert!(!belief.cause.is_empty() && belief.origin.is_some());
                    self.reasons.push(belief);
                    let press = self.kitchen.try_press(self.state, Agent::Human, button);
                    self.state = press.after;
                    self.presses.push((due.as_secs_f64(), button));
                    self.one.on_press(due, &press);
                }
                None => {}
            }
            self.check_beliefs();
        }
        self.now = end;
    }

    fn check_beliefs(&self) {
        for (id, aspect) in self.kitchen.aspect_ids().zip(&self.kitchen.aspects) {
            let values = self.one.beliefs().distribution(id);
            let total: f64 = values.iter().sum();
            assert!((total - 1.0).abs() < 1e-9, "{} sums to {total}", aspect.name);
            assert!(values.iter().all(|p| p.is_finite() && *p > 0.0), "{}", aspect.name);
        }
    }
}

/// Nothing draws its eye.
pub fn unmoved() -> Population {
    Population { capture: exactly(0.0), order_capture: exactly(0.0), ..Population::default() }
}

/// A trait that is the same in all people.
pub fn exactly(median: f64) -> TraitSpread {
    TraitSpread { median, sigma: 0.0 }
}

/// People who know hardly any recipe.
pub fn ignorant() -> Population {
    Population { learned: exactly(0.02), half_forgotten: exactly(0.02), ..unmoved() }
}

#[test]
fn the_same_seed_does_the_same_and_another_one_something_else() {
    let actions = |seed| {
        let mut bench = Bench::new(&Population::default(), seed);
        bench.order("order_1", "crab maki");
        bench.pass(60.0);
        (bench.samples, bench.presses, bench.one.person().clone())
    };
    assert_eq!(actions(3), actions(3));
    let (ours, theirs) = (actions(3), actions(4));
    assert_ne!(ours.1, theirs.1);
    assert_ne!(ours.2, theirs.2, "individuals differ");
}

#[test]
fn it_makes_what_is_ordered_by_itself() {
    // The robot stands still. Some take a wrong recipe for the right one and need several attempts.
    let mut served = 0;
    for seed in 0..20 {
        let mut bench = Bench::new(&Population::default(), seed);
        let order = bench.location("order_1");
        bench.order("order_1", "crab maki");
        bench.pass(300.0);
        served += usize::from(bench.state.order(order) == OrderContent::Served);
        let intervals: Vec<f64> = bench.presses.windows(2).map(|two| two[1].0 - two[0].0).collect();
        let quick = intervals.iter().filter(|interval| **interval < 4.0).count();
        assert!(quick * 2 > intervals.len(), "seed {seed}: {intervals:?}");
    }
    assert!(served >= 15, "{served} of 20 in five minutes");
}

#[test]
fn a_change_that_was_not_seen_stays_unknown_until_it_is_looked_at() {
    for seed in 0..10 {
        let mut bench = Bench::new(&unmoved(), seed);
        bench.pass(1.0);
        bench.put("counter", "rice raw");
        bench.pass(0.1);
        assert!(bench.p_truth("counter") < 0.5, "seed {seed}: seen without a look");
        bench.pass(60.0);
        assert!(bench.p_truth("counter") > 0.5, "seed {seed}: never looked at in a minute");
    }
}

#[test]
fn of_a_robot_press_it_knows_only_that_it_happened() {
    let mut bench = Bench::new(&unmoved(), 1);
    let press = bench.press(Agent::Robot, ButtonId(0), true);
    for _ in 0..3 {
        bench.one.on_press(bench.now, &press);
    }
    assert!(bench.p_truth("robot_hand") < 0.9 && bench.p_truth("robot_hand") > 0.4, "unsure of the robot's hand");
    assert!(bench.p_truth("counter") > 0.8, "not of the places that were empty");
    bench.check_beliefs();
}

#[test]
fn a_noticed_signal_makes_the_aspect_right() {
    // Nobody knows the recipe of the tuna nigiri, and nothing but the signal can tell within two seconds.
    let mut learned = 0;
    for seed in 0..200 {
        let mut bench = Bench::new(&ignorant(), seed);
        bench.order("order_1", "tuna nigiri");
        assert!(bench.p_truth("recipe of tuna nigiri") < 0.5);
        bench.show_recipe();
        bench.pass(0.45);
        assert!(bench.p_truth("recipe of tuna nigiri") < 0.5, "nobody reads as fast as that");
        bench.pass(1.2);
        learned += usize::from(bench.p_truth("recipe of tuna nigiri") > 0.9);
    }
    assert!((130..=176).contains(&learned), "{learned} of 200 recipes shown were learned");
    let mut bench = Bench::new(&unmoved(), 2);
    bench.put("cooking_pot", "rice cooked");
    for _ in 0..5 {
        bench.highlight("cooking_pot");
        bench.pass(2.0);
    }
    assert!(bench.p_truth("cooking_pot") > 0.9);
}

#[test]
fn nothing_else_is_seen_or_pressed_while_a_signal_is_read() {
    // It reads for exactly two seconds, half a second after each signal.
    let slow = Population { signal_after_s: [0.5, 0.5], reads_signal_s: [2.0, 2.0], ..Population::default() };
    let mut read = 0;
    for seed in 0..40 {
        let mut bench = Bench::new(&slow, seed);
        bench.order("order_1", "tuna nigiri");
        bench.pass(20.0);
        let counter = AspectId(bench.location("counter").0);
        bench.show_recipe();
        bench.pass(0.6);
        let busy = bench.now.as_secs_f64();
        if bench.p_truth("recipe of tuna nigiri") < 0.96 {
            continue;
        }
        read += 1;
        let believed = bench.one.beliefs().distribution(counter).to_vec();
        bench.put("counter", "salmon raw");
        bench.pass(1.8);
        assert_eq!(bench.one.beliefs().distribution(counter), believed, "seed {seed}: seen while reading");
        assert!(bench.presses.iter().all(|(time, _)| *time <= busy), "seed {seed}: pressed while reading");
    }
    assert!(read >= 20, "{read} of 40 signals were read");
}

#[test]
fn after_useless_signals_the_next_ones_are_noticed_less() {
    let population = Population { tires_of_signals: exactly(0.5), ..ignorant() };
    let noticed_after = |useless: u32| {
        let noticed = |seed: u64| {
            let mut bench = Bench::new(&population, seed);
            bench.order("order_1", "tuna nigiri");
            for _ in 0..useless {
                bench.highlight("human_hand");
                bench.pass(4.0);
            }
            bench.knows_when_shown()
        };
        (0..100).filter(|&seed| noticed(seed)).count()
    };
    let (fresh, tired) = (noticed_after(0), noticed_after(4));
    assert!(fresh >= 65 && tired <= fresh - 20, "{fresh} of 100 at first, {tired} after four useless ones");
}

#[test]
fn it_records_where_its_presses_come_from() {
    let never = exactly(0.000_001);
    let sure = Population { slip: never, look_alike_slip: never, thoughtless: never, ..unmoved() };
    let wrong = exactly(0.02);
    let ignorant = Population { learned: wrong, half_forgotten: wrong, confuses_look_alikes: 1000.0, ..sure.clone() };
    let clumsy = Population { slip: exactly(0.99), ..sure.clone() };
    let knowing = Population { all_knowing: true, ..sure };
    let reasons = |population: &Population, seed: u64| {
        let mut bench = Bench::new(population, seed);
        bench.order("order_1", "shrimp nigiri");
        bench.pass(30.0);
        bench.reasons
    };
    let mut about_the_recipe = 0;
    for seed in 0..10 {
        assert!(reasons(&knowing, seed).iter().all(|one| one.origin == Some(PressOrigin::Plan)), "seed {seed}");
        let slips = reasons(&clumsy, seed).iter().filter(|one| one.origin == Some(PressOrigin::Slip)).count();
        assert!(slips > 5, "seed {seed}: {slips}");
        let of_recipe = |one: &&RecordedBelief| one.targets == ["recipe of shrimp nigiri"];
        let believed = reasons(&ignorant, seed);
        about_the_recipe += usize::from(believed.iter().filter(of_recipe).count() > 0);
        let named = |one: &RecordedBelief| (one.origin == Some(PressOrigin::Belief)) != one.targets.is_empty();
        assert!(
            believed.iter().all(named),
            "seed {seed}: a target for every press from a false belief, and for no other"
        );
    }
    assert!(about_the_recipe >= 7, "{about_the_recipe} of 10 take crab for shrimp");
}

#[test]
fn a_signal_taken_back_in_time_is_not_read() {
    let ignorant = Population { learned: exactly(0.02), ..unmoved() };
    for seed in 0..40 {
        let mut bench = Bench::new(&ignorant, seed);
        bench.order("order_1", "tuna nigiri");
        bench.show_recipe();
        bench.pass(0.3);
        bench.one.on_signal_end(false);
        let before = bench.p_truth("recipe of tuna nigiri");
        bench.pass(0.3);
        assert!(bench.p_truth("recipe of tuna nigiri") <= before.max(0.5), "seed {seed}");
    }
}

#[test]
fn it_learns_from_a_press_without_effect() {
    // It believes in an empty pot; rice that will not go in says otherwise.
    let mut bench = Bench::new(&unmoved(), 1);
    let pot = bench.kitchen.button_named(Agent::Human, "cooking_pot").expect("a button");
    let take = bench.kitchen.button_named(Agent::Human, "take rice").expect("a button");
    bench.put("human_hand", "rice raw");
    bench.one.on_press(bench.now, &bench.press(Agent::Human, take, true));
    bench.put("cooking_pot", "crab raw");
    let empty = |bench: &Bench| {
        let aspect = AspectId(bench.location("cooking_pot").0);
        bench.one.beliefs().distribution(aspect)[0]
    };
    assert!(empty(&bench) > 0.9);
    bench.one.on_press(bench.now, &bench.press(Agent::Human, pot, false));
    assert!(empty(&bench) < 0.6, "{}", empty(&bench));
    bench.check_beliefs();
}

#[test]
fn its_eyes_are_like_eyes() {
    let mut bench = Bench::new(&Population::default(), 5);
    bench.order("order_1", "salmon nigiri");
    bench.pass(60.0);
    assert_eq!(bench.samples.len(), 60 * 120 + 1);
    let total = bench.samples.len() as f64;
    let blinks = bench.samples.iter().filter(|sample| sample.confidence < MIN_CONFIDENCE).count() as f64;
    assert!((0.01..0.1).contains(&(blinks / total)), "{} of the samples in blinks", blinks / total);
    let on_places = bench
        .samples
        .iter()
        .filter_map(|sample| nearest_location(&bench.kitchen, [sample.x, sample.y]))
        .filter(|(_, distance_m)| *distance_m < 0.035)
        .count() as f64;
    assert!(on_places / total > 0.6, "{} of the samples within a degree of a place", on_places / total);
    let still = bench.samples.windows(2).filter(|two| (two[1].x - two[0].x).hypot(two[1].y - two[0].y) < 0.02).count();
    assert!(still as f64 / total > 0.75, "fixations last longer than saccades");
}

#[test]
fn a_pause_only_postpones() {
    let play = |pause: bool| {
        let mut bench = Bench::new(&Population::default(), 8);
        bench.order("order_1", "shrimp nigiri");
        bench.pass(10.0);
        if pause {
            let by = SessionTime::from_secs_f64(100.0);
            bench.one.postpone(by);
            bench.now = bench.now + by;
        }
        bench.pass(20.0);
        bench.presses.iter().map(|(_, button)| *button).collect::<Vec<_>>()
    };
    assert_eq!(play(false), play(true));
}

#[test]
fn a_noticed_proposal_is_followed_whatever_is_believed_and_says_nothing() {
    let always = |median| Population { follows_proposal: exactly(median), ..Population::default() };
    // Crab has nothing to do with the order.
    let share = |population: &Population, is_outdated: bool| {
        let mut followed = 0;
        for seed in 0..100 {
            let mut bench = Bench::new(population, seed);
            bench.order("order_1", "tuna nigiri");
            bench.pass(10.0);
            let crab = bench.kitchen.button_named(Agent::Human, "take crab").expect("a button");
            let (presses, reasons) = (bench.presses.len(), bench.reasons.len());
            bench.one.on_signal(bench.now, None, &Signal::Propose(vec!["take crab".to_string()]));
            bench.pass(1.6);
            if is_outdated {
                bench.one.on_signal_end(true);
            }
            bench.pass(5.0);
            let made = bench.presses[presses..].iter().zip(&bench.reasons[reasons..]);
            let mut made = made.filter(|(_, reason)| reason.cause.contains("proposed"));
            if let Some(((_, button), reason)) = made.next() {
                followed += 1;
                assert_eq!((*button, reason.origin), (crab, Some(PressOrigin::Plan)), "seed {seed}");
            }
            assert!(made.next().is_none(), "seed {seed}: it was one press");
        }
        followed
    };
    let (all, none) = (share(&always(0.999_999), false), share(&always(0.0), false));
    assert!((60..=90).contains(&all), "{all} of 100, of whom some do not notice it");
    assert_eq!(none, 0, "nobody follows");
    assert!(share(&always(0.999_999), true) < all, "what is out of date is not made");
}
