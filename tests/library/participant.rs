//! Simulated participants: they err at the rates of people, for reasons that can be named.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::Path;
use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::communication::Signal;
use tomcom::edge::files::read_kitchen;
use tomcom::gaze::{GazeSample, MIN_CONFIDENCE, nearest_location};
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, AspectId, AspectKind, ButtonId, ContentId, DishId, Kitchen, LocationId, OrderContent};
use tomcom::kitchen::{Press, Recipes, State};
use tomcom::mind::BeliefWitness;
use tomcom::participant::population::{Experience, Population, TraitSpread};
use tomcom::participant::{ParticipantAction, SimulatedParticipant};
use tomcom::run::engine::Engine;
use tomcom::run::headless;
use tomcom::session::{Event, SessionSpec, Stamped};

fn kitchen(name: &str) -> Arc<Kitchen> {
    match read_kitchen(Path::new(&format!("layouts/{name}.toml"))) {
        Ok(files) => Arc::new(files.kitchen),
        Err(error) => panic!("{error}"),
    }
}

fn settings(seed: u64) -> SessionSpec {
    let text = format!("layout = \"\"\nseed = {seed}\n[trial]\ncondition = \"none\"\n[assistant]\nshadow = \"off\"\n");
    toml::from_str(&text).expect("settings of a session")
}

/// What came of some trials.
#[derive(Debug, Default)]
struct Figures {
    seconds: f64,
    human: usize,
    robot: usize,
    errors: usize,
    related: usize,
    /// Lengths of the error sequences.
    sequences: Vec<usize>,
    /// Presses of both agents for each served order.
    per_order: Vec<u32>,
    /// The longest time without a press of anybody, in seconds.
    longest_standstill_s: f64,
    /// Errors by the first word of their cause, or by the kind of aspect that was false.
    causes: BTreeMap<String, usize>,
    error_share: Vec<f64>,
    wall_s: f64,
}

/// Log-probability of a press under the softmax of the assistant's model, for a state held for certain.
fn log_likelihood(kitchen: &Kitchen, cost: &mut CostToGo, state: State, recipes: &Recipes, pressed: ButtonId) -> f64 {
    const TAU: f64 = 4.0;
    const LAPSE: f64 = 0.03;
    let count = kitchen.buttons[Agent::Human.index()].len();
    let mut value = |index: usize| {
        let next = kitchen.press(state, recipes, Agent::Human, ButtonId(index as u8)).unwrap_or(state);
        -TAU * f64::from(1 + cost.all_orders(next, recipes))
    };
    let values: Vec<f64> = (0..count).map(&mut value).collect();
    let top = values.iter().copied().fold(f64::MIN, f64::max);
    let total: f64 = values.iter().map(|value| (value - top).exp()).sum();
    let p = (values[pressed.index()] - top).exp() / total;
    ((1.0 - LAPSE) * p + LAPSE / count as f64).ln()
}

/// The state and recipes that a witness holds most likely.
fn believed(kitchen: &Kitchen, witness: &BeliefWitness) -> (State, Recipes) {
    let (mut state, mut recipes) = (kitchen.empty_state(), kitchen.true_recipes());
    for (aspect, held) in kitchen.aspects.iter().zip(&witness.aspects) {
        let value = aspect.labels.iter().position(|label| *label == held.believes).expect("a value of the aspect");
        match aspect.kind {
            AspectKind::Location(location) => state.set_code(location, aspect.values[value]),
            AspectKind::Recipe(dish) => recipes.set(dish, ContentId(aspect.values[value])),
        }
    }
    (state, recipes)
}

fn kind_of(cause: &str) -> String {
    match cause.split_once(": ") {
        Some((aspect, _)) if aspect.starts_with("believes recipe") => "believes recipe".to_string(),
        Some((head, _)) => head.to_string(),
        None => cause.to_string(),
    }
}

/// Plays unassisted trials and measures them; belief related errors by the definition of the study, with the point belief.
fn play(kitchen: &Arc<Kitchen>, seed: u64, trials: u64) -> Figures {
    let began = std::time::Instant::now();
    let mut figures = Figures::default();
    let mut cost = CostToGo::new(kitchen.clone());
    for trial in 0..trials {
        let mut engine = Engine::new(kitchen.clone(), settings(seed), trial, cost.clone());
        let mut events: Vec<Stamped> = Vec::new();
        let keep = |stamped: &Stamped| {
            if !matches!(stamped.event, Event::Gaze(_)) {
                events.push(stamped.clone());
            }
            Ok::<(), Infallible>(())
        };
        headless::run(&mut engine, keep).unwrap_or_else(|never| match never {});
        measure(kitchen, &mut cost, &engine, &events, &mut figures);
    }
    figures.wall_s = began.elapsed().as_secs_f64();
    figures
}

/// The task state after an event.
fn after(kitchen: &Kitchen, mut state: State, event: &Event) -> State {
    let order = |name: &str| kitchen.location_named(name).expect("an order");
    match event {
        Event::OrderShown { order: name, dish } => {
            let dish = kitchen.dishes.iter().position(|other| other.name == *dish).expect("a dish");
            state.set_order(order(name), OrderContent::Dish(DishId(dish as u8)));
        }
        Event::OrderCleared { order: name } => state.set_order(order(name), OrderContent::None),
        Event::Press { agent, button, .. } => {
            let button = kitchen.button_named(*agent, button).expect("a button");
            return kitchen.press(state, &kitchen.true_recipes(), *agent, button).unwrap_or(state);
        }
        _ => {}
    }
    state
}

fn measure(kitchen: &Kitchen, cost: &mut CostToGo, engine: &Engine, events: &[Stamped], figures: &mut Figures) {
    let session = engine.session();
    figures.seconds += session.trial_clock(session.time).as_secs_f64();
    figures.robot += session.presses[Agent::Robot.index()] as usize;
    let mut before = 0;
    for served in &session.served {
        figures.per_order.push(served.presses - before);
        before = served.presses;
    }
    let mut judged = engine.judged().iter().peekable();
    let mut witness = BeliefWitness::default();
    let (mut errors, mut presses, mut since_error, mut sequence) = (0, 0, 0, 0);
    let mut last_press = 0.0;
    let mut state = kitchen.empty_state();
    for stamped in events {
        let now = stamped.time.as_secs_f64();
        if let Event::Press { .. } = stamped.event {
            figures.longest_standstill_s = figures.longest_standstill_s.max(now - last_press);
            last_press = now;
        }
        match &stamped.event {
            Event::ParticipantBelieves(belief) => witness = belief.clone(),
            Event::Press { agent: Agent::Human, button, .. } => {
                let press = judged.next_if(|press| press.seq == stamped.seq).expect("a verdict for every press");
                presses += 1;
                if press.verdict.error {
                    errors += 1;
                    let button = kitchen.button_named(Agent::Human, button).expect("a button");
                    let (held, recipes) = believed(kitchen, &witness);
                    let gain = log_likelihood(kitchen, cost, held, &recipes, button)
                        - log_likelihood(kitchen, cost, state, &kitchen.true_recipes(), button);
                    let is_related = gain >= 3.0_f64.ln();
                    let mark = if is_related { "" } else { " (not related)" };
                    *figures.causes.entry(kind_of(&witness.cause) + mark).or_default() += 1;
                    if is_related {
                        figures.related += 1;
                        if sequence > 0 && since_error > 3 {
                            figures.sequences.push(sequence);
                            sequence = 0;
                        }
                        sequence += 1;
                        since_error = 0;
                    }
                } else {
                    since_error += 1;
                }
            }
            _ => {}
        }
        state = after(kitchen, state, &stamped.event);
    }
    if sequence > 0 {
        figures.sequences.push(sequence);
    }
    figures.human += presses;
    figures.errors += errors;
    figures.error_share.push(errors as f64 / presses.max(1) as f64);
}

impl Figures {
    fn print(&self, title: &str) {
        let mut per_order = self.per_order.clone();
        per_order.sort_unstable();
        let quantile = |q: f64| per_order[((per_order.len() - 1) as f64 * q) as usize];
        let mean_sequence = self.sequences.iter().sum::<usize>() as f64 / self.sequences.len().max(1) as f64;
        let mut shares = self.error_share.clone();
        shares.sort_by(f64::total_cmp);
        println!(
            "{title}: errors {:.1} % of {} human presses ({:.1} to {:.1} %), related {:.0} %, {} sequences of {:.2}; \
             {:.1} orders in 15 min, {} presses each (90 %: {}, most {}); robot {}; human every {:.2} s; \
             standstill {:.1} s; {:.0} s in {:.1} s",
            100.0 * self.errors as f64 / self.human as f64,
            self.human,
            100.0 * shares[0],
            100.0 * shares[shares.len() - 1],
            100.0 * self.related as f64 / self.errors.max(1) as f64,
            self.sequences.len(),
            mean_sequence,
            self.per_order.len() as f64 / self.seconds * 900.0,
            quantile(0.5),
            quantile(0.9),
            quantile(1.0),
            self.robot,
            self.seconds / self.human as f64,
            self.longest_standstill_s,
            self.seconds,
            self.wall_s,
        );
        let mut lengths: BTreeMap<usize, usize> = BTreeMap::new();
        for &length in &self.sequences {
            *lengths.entry(length).or_default() += 1;
        }
        println!("    sequences by length: {lengths:?}");
        for (cause, count) in &self.causes {
            println!("    {count:5} {cause}");
        }
    }
}

/// A participant before a kitchen that nobody else changes.
struct Bench {
    kitchen: Arc<Kitchen>,
    cost: CostToGo,
    state: State,
    now: SessionTime,
    one: SimulatedParticipant,
    samples: Vec<GazeSample>,
    presses: Vec<(f64, ButtonId)>,
}

impl Bench {
    fn new(population: &Population, seed: u64) -> Bench {
        let kitchen = kitchen("sushi");
        let state = kitchen.empty_state();
        let mut one = SimulatedParticipant::new(kitchen.clone(), population, seed, 0, 0, Experience::default());
        assert_eq!(one.next_due(), None, "nothing before the trial");
        one.on_trial_start(SessionTime::ZERO, state);
        let cost = CostToGo::new(kitchen.clone());
        Bench { kitchen, cost, state, now: SessionTime::ZERO, one, samples: Vec::new(), presses: Vec::new() }
    }

    fn location(&self, name: &str) -> LocationId {
        self.kitchen.location_named(name).expect("a location")
    }

    fn put(&mut self, location: &str, content: &str) {
        let content = self.kitchen.content_named(content).expect("a content");
        self.state.set_content(self.location(location), content);
    }

    fn order(&mut self, location: &str, dish: &str) {
        let dish = self.kitchen.dishes.iter().position(|other| other.name == dish).expect("a dish");
        self.state.set_order(self.location(location), OrderContent::Dish(DishId(dish as u8)));
    }

    /// What it gives to the truth about an aspect.
    fn p_truth(&self, aspect: &str) -> f64 {
        let index = self.kitchen.aspects.iter().position(|other| other.name == aspect).expect("an aspect");
        self.one.beliefs().p_truth(&self.kitchen, self.state, AspectId(index as u8))
    }

    /// A press that left the kitchen as it is now.
    fn press(&self, agent: Agent, button: ButtonId, effective: bool) -> Press {
        Press { agent, button, before: self.state, after: self.state, effective }
    }

    /// Lets so much time pass; presses have their effect.
    fn pass(&mut self, seconds: f64) {
        let end = self.now + SessionTime::from_secs_f64(seconds);
        while let Some(due) = self.one.next_due().filter(|&due| due <= end) {
            assert!(due >= self.now, "time runs forwards");
            self.now = due;
            match self.one.act(due, self.state, &mut self.cost) {
                Some(ParticipantAction::Gaze(sample)) => self.samples.push(sample),
                Some(ParticipantAction::Press { button, belief }) => {
                    assert!(!belief.cause.is_empty());
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
        for index in 0..self.kitchen.aspects.len() {
            let values = self.one.beliefs().distribution(AspectId(index as u8));
            let total: f64 = values.iter().sum();
            assert!((total - 1.0).abs() < 1e-9, "{} sums to {total}", self.kitchen.aspects[index].name);
            assert!(values.iter().all(|p| p.is_finite() && *p > 0.0), "{}", self.kitchen.aspects[index].name);
        }
    }
}

/// Nothing draws its eye.
fn unmoved() -> Population {
    let never = TraitSpread { median: 0.0, sigma: 0.0 };
    Population { capture: never, order_capture: never, ..Population::default() }
}

#[test]
fn the_same_seed_does_the_same_and_another_one_something_else() {
    let deeds = |seed| {
        let mut bench = Bench::new(&Population::default(), seed);
        bench.order("order_1", "crab maki");
        bench.pass(60.0);
        (bench.samples, bench.presses, bench.one.person().clone())
    };
    assert_eq!(deeds(3), deeds(3));
    let (ours, theirs) = (deeds(3), deeds(4));
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
    let ignorant = Population {
        learned: TraitSpread { median: 0.02, sigma: 0.0 },
        half_forgotten: TraitSpread { median: 0.02, sigma: 0.0 },
        ..unmoved()
    };
    let (mut shown, mut learned) = (0, 0);
    for seed in 0..200 {
        let mut bench = Bench::new(&ignorant, seed);
        bench.order("order_1", "tuna nigiri");
        assert!(bench.p_truth("recipe of tuna nigiri") < 0.5);
        let order = bench.location("order_1");
        let signal = Signal::ShowRecipe("order_1".to_string());
        bench.one.on_signal(bench.now, order, &signal, bench.state);
        bench.pass(0.45);
        assert!(bench.p_truth("recipe of tuna nigiri") < 0.5, "nobody reads as fast as that");
        bench.pass(1.2);
        shown += 1;
        learned += usize::from(bench.p_truth("recipe of tuna nigiri") > 0.9);
    }
    let share = f64::from(learned as u32) / f64::from(shown);
    assert!((0.65..=0.88).contains(&share), "{share} of the recipes shown were learned");
    let mut bench = Bench::new(&unmoved(), 2);
    bench.put("cooking_pot", "rice cooked");
    let pot = bench.location("cooking_pot");
    for _ in 0..5 {
        bench.one.on_signal(bench.now, pot, &Signal::Highlight("cooking_pot".to_string()), bench.state);
        bench.pass(2.0);
    }
    assert!(bench.p_truth("cooking_pot") > 0.9);
}

#[test]
fn a_signal_taken_back_in_time_is_not_read() {
    let ignorant = Population { learned: TraitSpread { median: 0.02, sigma: 0.0 }, ..unmoved() };
    for seed in 0..40 {
        let mut bench = Bench::new(&ignorant, seed);
        bench.order("order_1", "tuna nigiri");
        let order = bench.location("order_1");
        bench.one.on_signal(bench.now, order, &Signal::ShowRecipe("order_1".to_string()), bench.state);
        bench.pass(0.3);
        bench.one.on_signal_end(bench.now);
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

/// Bounds for a few trials; they hold with room to spare for many.
fn check(name: &str, seed: u64, trials: u64) {
    let kitchen = kitchen(name);
    let figures = play(&kitchen, seed, trials);
    figures.print(&format!("{name} {seed}"));
    let share = figures.errors as f64 / figures.human as f64;
    assert!((0.04..=0.16).contains(&share), "{share}");
    assert!(figures.per_order.len() as f64 / figures.seconds * 900.0 >= 25.0);
    assert!(figures.related as f64 / figures.errors as f64 > 0.6);
    assert!(figures.longest_standstill_s < 60.0);
    let nameless: usize =
        figures.causes.iter().filter(|(cause, _)| cause.starts_with("as it is")).map(|(_, n)| n).sum();
    assert!(nameless * 50 <= figures.errors, "{nameless} errors without a cause");
    let (least, most) = figures.error_share.iter().fold((1.0_f64, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
    assert!(most > 1.3 * least, "individuals differ");
}

#[test]
fn the_default_population_errs_as_people_do_in_sushi() {
    check("sushi", 5, 6);
}

#[test]
fn the_default_population_errs_as_people_do_in_burgers() {
    check("burger", 5, 6);
}

#[test]
#[ignore = "prints the figures of the default population over many trials; run it in release"]
fn calibration() {
    for name in ["sushi", "burger"] {
        let kitchen = kitchen(name);
        for seed in [7, 11, 23] {
            play(&kitchen, seed, 20).print(&format!("{name} {seed}"));
        }
    }
}
