//! Arm, table and buttons in space.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use super::colours;
use super::shown::{Point, Row, Shown};
use crate::base::time::SessionTime;
use crate::console::words;
use crate::kitchen::{Agent, Button, ButtonId, Kitchen};
use crate::robot::kinematics::{Arm, Joints};
use crate::robot::motion::ArmMotion;
use crate::robot::reach::BUTTON_M;
use crate::robot::urdf::{Shape, Solid};
use crate::session::{Event, Session, Stamped};

/// So often the arm is shown while it moves.
const EVERY_NS: u64 = 50_000_000;
/// The table reaches so far beyond the buttons, in metres, and is so thick.
const EDGE_M: f64 = 0.1;
const THICK_M: f64 = 0.03;
/// Radius of a button, and of the marks of what is pressed, in metres.
const BUTTON_RADIUS_M: f64 = 0.02;
const MARK_M: f64 = 0.022;

/// The arm as it is shown.
#[derive(Clone, Debug)]
pub struct ArmScene {
    arm: Arm,
    motion: ArmMotion,
    /// Until when it is shown, and how it stood then.
    until: SessionTime,
    joints: Joints,
}

impl ArmScene {
    pub fn new(kitchen: &Kitchen, now: SessionTime) -> ArmScene {
        let arm = Arm::ur5();
        let motion = ArmMotion::new(kitchen, &arm);
        let joints = motion.at(now);
        ArmScene { arm, motion, until: now, joints }
    }

    /// Table, buttons, and the shapes of the links.
    pub fn fixed(&self, kitchen: &Kitchen) -> Vec<Row> {
        let mut rows = vec![Row::new("robot/table", table(kitchen))];
        for (alone, name) in [(None, "shared"), (Some(Agent::Human), "human"), (Some(Agent::Robot), "robot")] {
            rows.push(Row::new(format!("robot/buttons/{name}"), buttons(kitchen, alone)));
        }
        for (index, link) in self.arm.links.iter().enumerate() {
            let colour = if index % 2 == 0 { colours::JOINT } else { colours::STEEL };
            rows.push(Row::new(entity(&link.name), Shown::Solids(link.solids.clone(), colour)));
        }
        rows
    }

    /// How it stands.
    pub fn opening(&self) -> Vec<Row> {
        let places = self.arm.forward(&self.joints);
        let links = self.arm.links.iter().zip(places).skip(1);
        links.map(|(link, place)| Row::new(entity(&link.name), Shown::Place(place))).collect()
    }

    /// How it moved since it was shown last, until this time.
    pub fn until(&mut self, time: SessionTime) -> Vec<(SessionTime, Vec<Row>)> {
        let mut moments = Vec::new();
        // Where it rests it is not shown again: time goes by at once.
        let end = time.min(self.motion.rests_at() + SessionTime(EVERY_NS));
        let mut at = SessionTime((self.until.0 / EVERY_NS + 1) * EVERY_NS);
        while at <= end {
            let joints = self.motion.at(at);
            if joints != self.joints {
                self.joints = joints;
                moments.push((at, self.opening()));
            }
            at = at + SessionTime(EVERY_NS);
        }
        self.until = self.until.max(time);
        moments
    }

    /// What an event that was just applied changes.
    pub fn follow(&mut self, session: &Session, stamped: &Stamped) -> Vec<Row> {
        let now = stamped.time;
        let kitchen = &session.kitchen;
        match &stamped.event {
            Event::RobotIntends { .. } | Event::TrialResumed => {
                let Some((button, _, until)) = session.robot.intention else { return Vec::new() };
                self.motion.set_out(now, button, until);
                vec![Row::new("robot/goal", Shown::Points(vec![mark(kitchen, Agent::Robot, button)]))]
            }
            Event::TrialPaused => {
                self.motion.stand(now);
                Vec::new()
            }
            Event::Press { agent: Agent::Human, button, .. } => {
                let button = kitchen.button_named(Agent::Human, button);
                let points = button.map(|button| mark(kitchen, Agent::Human, button));
                vec![Row::new("human/hand", Shown::Points(points.into_iter().collect()))]
            }
            Event::Press { agent: Agent::Robot, .. } | Event::RobotAborts { .. } => self.goes_up(now),
            Event::TrialEnded { .. } | Event::TrialAborted { .. } | Event::SessionEnded => self.goes_up(now),
            _ => Vec::new(),
        }
    }

    fn goes_up(&mut self, now: SessionTime) -> Vec<Row> {
        self.motion.go_up(now);
        vec![Row::new("robot/goal", Shown::Points(Vec::new()))]
    }
}

fn entity(link: &str) -> String {
    format!("robot/arm/{link}")
}

/// A mark on the button that an agent presses, with its name.
fn mark(kitchen: &Kitchen, agent: Agent, button: ButtonId) -> Point {
    let [x, y] = kitchen.button(agent, button).at_m;
    Point {
        at_m: [x, y, kitchen.table_height_m + BUTTON_M],
        radius_m: MARK_M,
        words: format!("{}: {}", agent.name(), words::button(kitchen, agent, button)),
        colour: colours::of(agent),
    }
}

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::identity())
}

/// A board below all buttons and the arm's base.
fn table(kitchen: &Kitchen) -> Shown {
    let all = kitchen.buttons.iter().flatten().map(|button| button.at_m).chain([[-0.1, 0.0], [0.1, 0.0]]);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for place in all {
        for axis in 0..2 {
            low[axis] = low[axis].min(place[axis] - EDGE_M);
            high[axis] = high[axis].max(place[axis] + EDGE_M);
        }
    }
    let half_m = [(high[0] - low[0]) / 2.0, (high[1] - low[1]) / 2.0, THICK_M / 2.0];
    let centre = at((high[0] + low[0]) / 2.0, (high[1] + low[1]) / 2.0, kitchen.table_height_m - THICK_M / 2.0);
    Shown::Solids(vec![Solid { shape: Shape::Box { half_m }, link_from_solid: centre }], colours::TABLE)
}

/// The buttons by who has them: both agents, or one alone.
fn buttons(kitchen: &Kitchen, alone: Option<Agent>) -> Shown {
    let of = |agent: Agent| &kitchen.buttons[agent.index()];
    let is_shared = |agent: Agent, button: &Button| of(agent.other()).iter().any(|other| other.at_m == button.at_m);
    let solid = |button: &Button| {
        let shape = Shape::Cylinder { radius_m: BUTTON_RADIUS_M, length_m: BUTTON_M };
        let [x, y] = button.at_m;
        Solid { shape, link_from_solid: at(x, y, kitchen.table_height_m + BUTTON_M / 2.0) }
    };
    let agent = alone.unwrap_or(Agent::Human);
    let those = of(agent).iter().filter(|button| is_shared(agent, button) == alone.is_none());
    Shown::Solids(those.map(solid).collect(), alone.map_or(colours::BUTTON, colours::of))
}
