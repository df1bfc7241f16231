//! What the orders of a trial took: time from appearance to serving, and presses beyond the least number.

use std::path::Path;

use tomcom::edge::files::read_session;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen, State};
use tomcom_session::{Event, Session, TimestampedEvent, apply};
use tomcom_study::analysis::trial_summary::{RegretSum, order_times};

use super::{at, kitchen};

/// Applies events a given time apart and sums the regret of presses.
struct Recorded {
    session: Session,
    regret: RegretSum,
    cost: CostToGo,
    seq: u64,
    now_s: f64,
}

impl Recorded {
    fn add(&mut self, after_s: f64, event: Event) {
        self.now_s += after_s;
        let stamped = TimestampedEvent { seq: self.seq, time: at(self.now_s), event };
        self.seq += 1;
        let applied = apply(&mut self.session, &stamped).expect("an event that fits");
        self.regret.note(&self.session.kitchen.clone(), &mut self.cost, &applied.change);
    }

    fn press(&mut self, agent: Agent, button: &str) {
        self.add(2.0, Event::Press { agent, button: button.to_string(), at_ns: None });
    }
}

/// A press of either agent that loses nothing.
fn best(kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> (Agent, String) {
    let recipes = kitchen.true_recipes();
    let here = cost.all_orders(state, &recipes);
    for agent in [Agent::Human, Agent::Robot] {
        for index in 0..kitchen.buttons[agent.index()].len() {
            let button = ButtonId(index as u8);
            let press = kitchen.press(state, &recipes, agent, button);
            if press.is_some_and(|after| cost.all_orders(after, &recipes) + 1 == here) {
                return (agent, kitchen.button(agent, button).name.clone());
            }
        }
    }
    panic!("no press brings the orders nearer");
}

#[test]
fn an_order_takes_the_time_from_its_appearance_and_every_lost_press() {
    let kitchen = kitchen();
    let mut cost = CostToGo::new(kitchen.clone());
    let spec = read_session(Path::new("sessions/default.toml")).expect("the default session").spec;
    let session = Session::new(kitchen.clone(), spec, 0);
    let mut recorded = Recorded { session, regret: RegretSum::default(), cost: cost.clone(), seq: 0, now_s: 0.0 };
    recorded.add(0.0, Event::TrialStarted);
    let dish = kitchen.dishes[0].name.clone();
    recorded.add(5.0, Event::OrderShown { order: "order_1".to_string(), dish: dish.clone() });
    recorded.add(7.0, Event::OrderShown { order: "order_2".to_string(), dish });
    assert_eq!(recorded.regret.per_order(0), None);
    // Three lost presses: rice that is taken and thrown away again, and a serving without a dish.
    recorded.press(Agent::Human, "take rice");
    recorded.press(Agent::Human, "trash");
    recorded.press(Agent::Human, "serve 1");
    let mut served_s = Vec::new();
    while served_s.len() < 2 {
        let (agent, button) = best(&kitchen, &mut cost, recorded.session.state);
        recorded.press(agent, &button);
        if recorded.session.served.len() > served_s.len() {
            served_s.push((recorded.now_s, button));
        }
    }
    let appeared_s = |button: &str| if button == "serve 1" { 5.0 } else { 12.0 };
    let wanted: Vec<f64> = served_s.iter().map(|(served_s, button)| served_s - appeared_s(button)).collect();
    assert_eq!(order_times(&recorded.session), wanted);
    // Taking rice brings the orders nearer, throwing it away loses that press and itself.
    assert_eq!(recorded.regret.per_order(2), Some(1.5));
}
