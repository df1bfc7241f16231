//! Scenarios: what should be said in a situation, and when to be silent. One file each in `tests/scenarios`.
//!
//! `cargo test --test scenarios -- --nocapture` prints every answer.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;
use tomcom::base::time::SessionTime;
use tomcom::communication::planner::Planner;
use tomcom::communication::recommendation::Recommendation;
use tomcom::communication::settings::AssistantSpec;
use tomcom::communication::situation::{RobotOutlook, Situation};
use tomcom::communication::{Signal, signals};
use tomcom::edge::files;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, AspectId, AspectKind, Kitchen, State};
use tomcom::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom::mind::model::HumanModel;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Scenario {
    /// What it is about, for whoever reads the answers.
    about: String,
    layout: String,
    /// By location, what it holds; the others are empty.
    state: BTreeMap<String, String>,
    /// How sure of every aspect's truth the human is where `belief` says nothing else.
    #[serde(default = "sure")]
    knows: f64,
    /// By aspect, the chances of its values; what is left is the truth's.
    #[serde(default)]
    belief: BTreeMap<String, BTreeMap<String, f64>>,
    #[serde(default)]
    robot: Robot,
    cost: Option<f64>,
    expect: Expect,
}

fn sure() -> f64 {
    0.98
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Robot {
    /// The button that the arm is on its way to, and when it touches it.
    button: Option<String>,
    in_s: f64,
    still: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Expect {
    /// "silence", or signals of which one is to be sent.
    says: Vec<String>,
    /// The press that it prevents.
    prevents: Option<Vec<String>>,
    /// Signals that are not worth sending.
    #[serde(default)]
    not: Vec<String>,
    /// Least and most benefit of the best signal.
    saves: Option<[f64; 2]>,
}

impl Scenario {
    fn read(path: &Path) -> Scenario {
        let text = std::fs::read_to_string(path).expect("a scenario file");
        toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    fn kitchen(&self) -> Arc<Kitchen> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("layouts").join(format!("{}.toml", self.layout));
        Arc::new(files::read_kitchen(&path).expect("a layout").kitchen)
    }

    fn state(&self, kitchen: &Kitchen) -> State {
        let (mut state, mut recipes) = (kitchen.empty_state(), kitchen.true_recipes());
        for (location, content) in &self.state {
            let location = kitchen.location_named(location).unwrap_or_else(|| panic!("no location {location}"));
            let aspect = AspectId::of_location(location);
            kitchen.set_value(&mut state, &mut recipes, aspect, value_named(kitchen, aspect, content));
        }
        state
    }

    fn belief(&self, kitchen: &Kitchen, state: State) -> DirichletBelief {
        for name in self.belief.keys() {
            assert!(kitchen.aspects.iter().any(|aspect| aspect.name == *name), "no aspect {name}");
        }
        let of = |index: usize| {
            let aspect = &kitchen.aspects[index];
            let id = AspectId(index as u8);
            let truth = kitchen.true_value(state, id);
            let told = self.belief.get(&aspect.name);
            let others = 1.0 - if told.is_some() { 1.0 } else { self.knows };
            let mut mean = vec![others / (aspect.values.len() - 1) as f64; aspect.values.len()];
            mean[truth] = 0.0;
            for (label, p) in told.into_iter().flatten() {
                mean[value_named(kitchen, id, label)] += p;
            }
            mean[truth] += 1.0 - mean.iter().sum::<f64>();
            let precision = match aspect.kind {
                AspectKind::Location(_) => 10.0,
                AspectKind::Recipe(_) => 0.6,
            };
            Dirichlet::new(mean, precision)
        };
        DirichletBelief { aspects: (0..kitchen.aspects.len()).map(of).collect() }
    }

    fn outlook(&self, kitchen: &Kitchen) -> RobotOutlook {
        match &self.robot.button {
            _ if self.robot.still => RobotOutlook::Still,
            Some(name) => {
                let button = kitchen.button_named(Agent::Robot, name).unwrap_or_else(|| panic!("no button {name}"));
                RobotOutlook::Busy { button, remaining_s: self.robot.in_s, driven: false }
            }
            None => RobotOutlook::Free,
        }
    }

    fn answer(&self, seed: u64) -> Recommendation {
        let kitchen = self.kitchen();
        let state = self.state(&kitchen);
        let belief = self.belief(&kitchen, state);
        let situation = Situation { state, belief: &belief, robot: self.outlook(&kitchen), robot_press_s: 2.4 };
        let spec = AssistantSpec::default();
        let spec = AssistantSpec { cost_of_communication: self.cost.unwrap_or(spec.cost_of_communication), ..spec };
        let signals: Vec<Signal> = signals(&kitchen, false).into_iter().map(|(_, signal)| signal).collect();
        let mut cost = CostToGo::new(kitchen.clone());
        Planner::new(kitchen, &HumanModel::default(), spec, seed).advise(
            &mut cost,
            &situation,
            &signals,
            0,
            SessionTime::ZERO,
        )
    }
}

fn value_named(kitchen: &Kitchen, aspect: AspectId, label: &str) -> usize {
    let aspect = &kitchen.aspects[aspect.index()];
    let found = aspect.labels.iter().position(|other| other == label);
    found.unwrap_or_else(|| panic!("{} has no value {label}, but {}", aspect.name, aspect.labels.join(", ")))
}

fn words(signal: &Signal) -> String {
    match signal {
        Signal::ShowRecipe(order) => format!("show recipe of {order}"),
        Signal::Highlight(location) => format!("highlight {location}"),
    }
}

/// What is wrong with an answer, if something is.
fn fault(expect: &Expect, answer: &Recommendation) -> Option<String> {
    let said = answer.best.as_ref().map_or("silence".to_string(), words);
    if !expect.says.contains(&said) {
        return Some(format!("says {said} instead of {}", expect.says.join(" or ")));
    }
    let top = answer.top();
    if let (Some([least, most]), Some(top)) = (expect.saves, top)
        && !(least..=most).contains(&top.benefit)
    {
        return Some(format!("{} saves {}, not {least} to {most}", words(&top.signal), top.benefit));
    }
    let prevents = answer.reason.as_ref().and_then(|reason| reason.prevents.clone());
    if let Some(wanted) = &expect.prevents
        && !prevents.as_ref().is_some_and(|button| wanted.contains(button))
    {
        return Some(format!("prevents {prevents:?} instead of {wanted:?}"));
    }
    let unwanted = answer.options.iter().find(|option| option.net > 0.0 && expect.not.contains(&words(&option.signal)));
    unwanted.map(|option| format!("{} has a net benefit of {}", words(&option.signal), option.net))
}

fn describe(name: &str, scenario: &Scenario, answer: &Recommendation) -> String {
    let mut text = format!("{name}: {}\n", scenario.about);
    text += &format!("  says {}\n", answer.best.as_ref().map_or("nothing".to_string(), words));
    for option in answer.options.iter().take(3) {
        let (benefit, error, rollouts) = (option.benefit, option.standard_error, option.rollouts);
        text += &format!("  {benefit:+.2} ±{error:.2}  {} ({rollouts} rollouts)\n", words(&option.signal));
    }
    if let Some(reason) = &answer.reason {
        text += &format!("  {}\n", reason.words());
    }
    text
}

fn scenarios() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios");
    let entries = std::fs::read_dir(folder).expect("the scenarios");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a file").path()).collect();
    paths.sort();
    paths
}

#[test]
fn every_scenario_gets_the_answer_that_it_asks_for() {
    let paths = scenarios();
    assert!(paths.len() >= 25, "{} scenarios", paths.len());
    let mut faults = Vec::new();
    for path in paths {
        let name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().to_string());
        let scenario = Scenario::read(&path);
        let answer = scenario.answer(1);
        print!("{}", describe(&name, &scenario, &answer));
        if let Some(fault) = fault(&scenario.expect, &answer) {
            println!("  NOT AS EXPECTED: {fault}");
            faults.push(format!("{name}: {fault}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn an_answer_depends_on_nothing_that_was_asked_before() {
    let paths = scenarios();
    let first = Scenario::read(&paths[0]);
    let kitchen = first.kitchen();
    let spec = AssistantSpec::default();
    let mut cost = CostToGo::new(kitchen.clone());
    let mut planner = Planner::new(kitchen.clone(), &HumanModel::default(), spec, 1);
    let signals: Vec<Signal> = signals(&kitchen, false).into_iter().map(|(_, signal)| signal).collect();
    for scenario in paths.iter().map(|path| Scenario::read(path)).filter(|other| other.layout == first.layout) {
        let state = scenario.state(&kitchen);
        let belief = scenario.belief(&kitchen, state);
        let robot = scenario.outlook(&kitchen);
        let situation = Situation { state, belief: &belief, robot, robot_press_s: 2.4 };
        if scenario.cost.is_none() {
            assert_eq!(
                planner.advise(&mut cost, &situation, &signals, 0, SessionTime::ZERO),
                scenario.answer(1),
                "{}",
                scenario.about
            );
        }
    }
}
