//! Simulated participants: they err at the rates of people, for reasons that can be named.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::Path;
use std::sync::Arc;

use tomcom::edge::files::read_kitchen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, AspectKind, ButtonId, ContentId, Kitchen, Recipes, State};
use tomcom::mind::BeliefWitness;
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
    let text = format!("layout = \"\"\nseed = {seed}\n[trial]\ncondition = \"none\"\n");
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
            if now - last_press > 15.0 && std::env::var("DEBUG_STILL").is_ok() {
                let f: Vec<String> = witness
                    .aspects
                    .iter()
                    .filter(|a| a.p_truth < 0.5)
                    .map(|a| format!("{}={} {:.2}", a.aspect, a.believes, a.p_truth))
                    .collect();
                let st: Vec<String> = kitchen
                    .locations
                    .iter()
                    .enumerate()
                    .map(|(i, l)| {
                        format!("{}={}", l.name, kitchen.content_label(state, tomcom::kitchen::LocationId(i as u8)))
                    })
                    .collect();
                println!(
                    "STILL {:.1}..{now:.1} {:?}\n  {}\n  false: {}\n  {}",
                    last_press,
                    stamped.event,
                    st.join(" "),
                    f.join(" | "),
                    witness.cause
                );
                let r = kitchen.true_recipes();
                println!(
                    "  C {} least {:?}",
                    cost.all_orders(state, &r),
                    Agent::BOTH.map(|a| (0..kitchen.buttons[a.index()].len())
                        .filter_map(|i| kitchen
                            .press(state, &r, a, ButtonId(i as u8))
                            .map(|n| (cost.all_orders(n, &r), kitchen.button(a, ButtonId(i as u8)).name.clone())))
                        .min())
                );
            }
            figures.longest_standstill_s = figures.longest_standstill_s.max(now - last_press);
            last_press = now;
        }
        match &stamped.event {
            Event::ParticipantBelieves(belief) => witness = belief.clone(),
            Event::Press { agent: Agent::Human, button } => {
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
        if let Event::OrderShown { order, dish } = &stamped.event {
            let order = kitchen.location_named(order).expect("an order");
            let dish = kitchen.dishes.iter().position(|other| other.name == *dish).expect("a dish");
            state.set_order(order, tomcom::kitchen::OrderContent::Dish(tomcom::kitchen::DishId(dish as u8)));
        }
        if let Event::OrderCleared { order } = &stamped.event {
            let order = kitchen.location_named(order).expect("an order");
            state.set_order(order, tomcom::kitchen::OrderContent::None);
        }
        if let Event::Press { agent, button } = &stamped.event {
            let button = kitchen.button_named(*agent, button).expect("a button");
            state = kitchen.press(state, &kitchen.true_recipes(), *agent, button).unwrap_or(state);
        }
    }
    if sequence > 0 {
        figures.sequences.push(sequence);
    }
    figures.human += presses;
    figures.errors += errors;
    figures.error_share.push(errors as f64 / presses.max(1) as f64);
}

impl Figures {
    fn print(&self, title: &str, optimum: f64) {
        let mut per_order = self.per_order.clone();
        per_order.sort_unstable();
        let quantile = |q: f64| per_order[((per_order.len() - 1) as f64 * q) as usize];
        let mean_sequence = self.sequences.iter().sum::<usize>() as f64 / self.sequences.len().max(1) as f64;
        let mut shares = self.error_share.clone();
        shares.sort_by(f64::total_cmp);
        println!(
            "{title}: errors {:.1} % of {} human presses ({:.1} to {:.1} %), related {:.0} %, {} sequences of {:.2}; \
             {:.1} orders in 15 min, {} presses each (90 %: {}, most {}) at best {optimum}; robot {}; human every {:.2} s; \
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
        for (cause, count) in &self.causes {
            println!("    {count:5} {cause}");
        }
    }
}

#[test]
#[ignore = "prints the figures of the default population; run it in release"]
fn calibration() {
    for name in ["sushi", "burger"] {
        let kitchen = kitchen(name);
        for seed in
            std::env::var("SEEDS").map_or(vec![7, 11, 23], |s| s.split(',').map(|x| x.parse().unwrap()).collect())
        {
            play(&kitchen, seed, 20).print(&format!("{name} {seed}"), 16.0);
        }
    }
}
