//! The robot arm, the table, the buttons and the participant's hand in 3D, for Rerun.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use super::entity_content::{self, CURVES, EntityData, EntityUpdate, ScenePoint, SeriesStyle, slug};
use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::kinematics::{CollisionSolid, LinkShape};
use tomcom_arm::physics::bodies::HandPose;
use tomcom_arm::reach::BUTTON_M;
use tomcom_arm::reaching::resting_place;
use tomcom_core::kitchen::{Agent, Button, ButtonId, Kitchen, KitchenChange, Press};
use tomcom_core::robot::SafetyMode;
use tomcom_core::robot::{ArmSample, JointAngles};
use tomcom_session::history::{event_words, wording};
use tomcom_session::{Event, Session, TimestampedEvent};

/// Margin of the table around the buttons, and thickness of the table, in metres.
const EDGE_M: f64 = 0.1;
const THICK_M: f64 = 0.03;
/// Radius of a button, and of the mark of a pressed button, in metres.
const BUTTON_RADIUS_M: f64 = 0.02;
const MARK_M: f64 = 0.022;

/// Height of a pressing hand above the table, in metres.
const ABOVE_TABLE_M: f64 = 0.05;
/// Least contact force that is shown at the arm's tip, in newtons.
const SHOWN_N: f64 = 0.5;
const FELT_M: f64 = 0.015;
/// Radius of the mark at a contact, in metres.
const CONTACT_M: f64 = 0.05;
/// Paths of the entities of the simulated arm: contact force, distance of the hand, safety mode, contact, hand.
const FORCE: &str = "robot/force";
const AWAY: &str = "robot/hand_away";
const SAFETY: &str = "robot/safety/mode";
const FELT: &str = "robot/felt";
const CONTACT: &str = "robot/contact";
const HAND: &str = "human/hand/shape";

/// The joints of a UR5 from base to tool.
const JOINTS: [&str; 6] = ["base", "shoulder", "elbow", "wrist 1", "wrist 2", "wrist 3"];

/// Arm, table, buttons and hand as the viewer shows them. Only of the physical arm: the poses of the timed arm are nowhere.
#[derive(Clone, Debug)]
pub struct RobotArmScene {
    arm: SerialArm,
    feels: bool,
}

impl RobotArmScene {
    /// `None` if the session records no poses of the arm.
    pub fn new(session: &Session) -> Option<RobotArmScene> {
        has_poses(session).then(|| RobotArmScene { arm: SerialArm::ur5(), feels: false })
    }

    /// Entities of the scene that do not change: table, buttons, and the shapes of the arm's links.
    pub fn fixed(&self, kitchen: &Kitchen) -> Vec<EntityUpdate> {
        let mut rows = vec![EntityUpdate::new("robot/table", table(kitchen))];
        for (alone, name) in [(None, "shared"), (Some(Agent::Human), "human"), (Some(Agent::Robot), "robot")] {
            rows.push(EntityUpdate::new(format!("robot/buttons/{name}"), buttons(kitchen, alone)));
        }
        for (index, link) in self.arm.links.iter().enumerate() {
            let colour = if index % 2 == 0 { entity_content::JOINT } else { entity_content::STEEL };
            rows.push(EntityUpdate::new(entity(&link.name), EntityData::Solids(link.solids.clone(), colour)));
        }
        for (name, colour) in JOINTS.into_iter().zip(CURVES) {
            let series = SeriesStyle::new(format!("{name} (degrees)"), colour);
            rows.push(EntityUpdate::new(joint(name), EntityData::Line(series)));
        }
        rows.extend(hand_shapes());
        for (entity, name, colour) in
            [(FORCE, "force on the arm (N)", entity_content::ROBOT), (AWAY, "hand away (cm)", entity_content::HUMAN)]
        {
            rows.push(EntityUpdate::new(entity, EntityData::Line(SeriesStyle::new(name, colour))));
        }
        rows
    }

    pub fn opening(&self, session: &Session) -> Vec<EntityUpdate> {
        let last = session.robot.arm.last.map(|(_, moment)| moment);
        // Before the first sample the arm has no pose.
        let mut rows = last.map_or_else(Vec::new, |moment| places(&self.arm, &moment.joints));
        let rests = resting_place(&session.kitchen).coords.into();
        let [x, y, z] = last.and_then(|moment| moment.hand_m).unwrap_or(rests);
        rows.push(EntityUpdate::new(HAND, EntityData::Place(at(x, y, z))));
        rows
    }

    /// Entity updates of arm and hand from an event that has just been applied to the session.
    pub fn follow(
        &mut self,
        session: &Session,
        stamped: &TimestampedEvent,
        change: &KitchenChange,
    ) -> Vec<EntityUpdate> {
        let kitchen = &session.kitchen;
        if let KitchenChange::Press { press: Press { agent, button, .. }, .. }
        | KitchenChange::UncountedPress { agent, button } = *change
        {
            return match agent {
                Agent::Human => {
                    vec![EntityUpdate::new("human/hand", EntityData::Points(vec![mark(kitchen, agent, button)]))]
                }
                Agent::Robot => no_goal(),
            };
        }
        match &stamped.event {
            Event::RobotIntends { .. } | Event::TrialResumed => {
                let Some((button, ..)) = session.robot.intention else { return Vec::new() };
                vec![EntityUpdate::new("robot/goal", EntityData::Points(vec![mark(kitchen, Agent::Robot, button)]))]
            }
            Event::RobotMoves(moment) => self.moves(moment),
            Event::RobotTouched { force_n } => {
                let mut rows = no_goal();
                rows.push(touched(session, format!("contact, {force_n:.0} N")));
                rows
            }
            Event::RobotSafety { mode, .. } => {
                let state = if *mode == SafetyMode::Normal { String::new() } else { mode.name().to_lowercase() };
                let mut rows = vec![EntityUpdate::new(SAFETY, EntityData::State(state, entity_content::ERROR))];
                if !mode.is_stopped() {
                    rows.push(EntityUpdate::new(CONTACT, EntityData::Points(Vec::new())));
                }
                rows
            }
            Event::RobotAborts { .. } => no_goal(),
            Event::TrialEnded { .. } | Event::TrialAborted { .. } | Event::SessionEnded => no_goal(),
            _ => Vec::new(),
        }
    }

    /// Entity updates from a sample of the simulated arm: the arm's pose, the contact force, the hand.
    fn moves(&mut self, moment: &ArmSample) -> Vec<EntityUpdate> {
        let mut rows = places(&self.arm, &moment.joints);
        rows.extend(moment.hand_m.map(|[x, y, z]| EntityUpdate::new(HAND, EntityData::Place(at(x, y, z)))));
        let felt = (moment.force_n >= SHOWN_N).then(|| ScenePoint {
            at_m: self.arm.tip(&moment.joints).translation.vector.into(),
            radius_m: FELT_M,
            words: String::new(),
            colour: entity_content::SIGNAL,
        });
        if felt.is_some() || self.feels {
            rows.push(EntityUpdate::new(FELT, EntityData::Points(felt.iter().cloned().collect())));
        }
        self.feels = felt.is_some();
        rows.push(EntityUpdate::new(FORCE, EntityData::Value(moment.force_n)));
        let away = moment.hand_away_m.map(|away_m| EntityUpdate::new(AWAY, EntityData::Value(away_m * 100.0)));
        rows.extend(away);
        rows
    }
}

fn no_goal() -> Vec<EntityUpdate> {
    vec![EntityUpdate::new("robot/goal", EntityData::Points(Vec::new()))]
}

/// Whether a session records the poses of the arm, so that they can be shown.
pub fn has_poses(session: &Session) -> bool {
    session.spec.robot.arm.has_joints()
}

/// What the robot does now, in words.
pub fn robot_does(session: &Session) -> String {
    let (robot, kitchen) = (&session.robot, &session.kitchen);
    if robot.is_stopped_by_wizard() {
        return "stopped by the wizard".to_string();
    }
    if robot.stopped {
        return event_words::why_stopped(&robot.arm);
    }
    if let Some((button, _, until)) = robot.intention {
        let left_s = until.secs_since(session.time).max(0.0).ceil();
        let by_itself = if robot.initiative { ", by its own initiative" } else { "" };
        let name = wording::button(kitchen, Agent::Robot, button);
        return format!("on its way to {name}{by_itself}, {left_s:.0} s left");
    }
    match &robot.idle {
        _ if robot.held => "held by the wizard".to_string(),
        Some((reason, buttons)) => {
            let names: Vec<&str> =
                buttons.iter().map(|&button| kitchen.button(Agent::Human, button).name.as_str()).collect();
            wording::idle(*reason, &names, robot.gave_up).swap_remove(0)
        }
        None => "waits".to_string(),
    }
}

fn places(arm: &SerialArm, joints: &JointAngles) -> Vec<EntityUpdate> {
    let links = arm.links.iter().zip(arm.forward(joints)).skip(1);
    let links = links.map(|(link, place)| EntityUpdate::new(entity(&link.name), EntityData::Place(place)));
    let angles = JOINTS.iter().zip(joints);
    let angles = angles.map(|(name, angle)| EntityUpdate::new(joint(name), EntityData::Value(angle.to_degrees())));
    links.chain(angles).collect()
}

fn joint(name: &str) -> String {
    format!("robot/joints/{}", slug(name))
}

/// Shapes of hand and forearm, as in the simulated physics: the forearm points away from the robot and slightly up.
fn hand_shapes() -> Vec<EntityUpdate> {
    let place = HandPose::reaching(Point3::origin(), -ABOVE_TABLE_M);
    let [hand, forearm] = place.capsules();
    let ball =
        CollisionSolid { shape: LinkShape::Sphere { radius_m: hand.radius_m }, link_from_solid: Isometry3::identity() };
    let [from, to] = forearm.ends_m;
    let along = UnitQuaternion::rotation_between(&Vector3::z(), &(to - from)).unwrap_or_else(UnitQuaternion::identity);
    let middle = Translation3::from(nalgebra::center(&from, &to).coords);
    let length_m = (to - from).norm() + 2.0 * forearm.radius_m;
    let shape = LinkShape::Cylinder { radius_m: forearm.radius_m, length_m };
    let forearm = CollisionSolid { shape, link_from_solid: Isometry3::from_parts(middle, along) };
    vec![EntityUpdate::new(HAND, EntityData::Solids(vec![ball, forearm], entity_content::SKIN))]
}

/// A mark at the position of the participant's hand, labelled with these words.
fn touched(session: &Session, words: String) -> EntityUpdate {
    let at_m = session.robot.arm.last.and_then(|(_, moment)| moment.hand_m).unwrap_or_default();
    EntityUpdate::new(
        CONTACT,
        EntityData::Points(vec![ScenePoint { at_m, radius_m: CONTACT_M, words, colour: entity_content::ERROR }]),
    )
}

fn entity(link: &str) -> String {
    format!("robot/arm/{link}")
}

fn mark(kitchen: &Kitchen, agent: Agent, button: ButtonId) -> ScenePoint {
    let [x, y] = kitchen.button(agent, button).at_m;
    ScenePoint {
        at_m: [x, y, kitchen.table_height_m + BUTTON_M],
        radius_m: MARK_M,
        // Words would cover the arm's tip and the buttons; the page says what is pressed.
        words: String::new(),
        colour: entity_content::agent_colour(agent),
    }
}

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::identity())
}

/// A table top below all buttons and the arm's base.
fn table(kitchen: &Kitchen) -> EntityData {
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
    EntityData::Solids(
        vec![CollisionSolid { shape: LinkShape::Box { half_m }, link_from_solid: centre }],
        entity_content::TABLE,
    )
}

/// Buttons that only one agent can press; with `None`, the buttons that both agents can press.
fn buttons(kitchen: &Kitchen, alone: Option<Agent>) -> EntityData {
    let of = |agent: Agent| &kitchen.buttons[agent.index()];
    let is_shared = |agent: Agent, button: &Button| of(agent.other()).iter().any(|other| other.at_m == button.at_m);
    let solid = |button: &Button| {
        let shape = LinkShape::Cylinder { radius_m: BUTTON_RADIUS_M, length_m: BUTTON_M };
        let [x, y] = button.at_m;
        CollisionSolid { shape, link_from_solid: at(x, y, kitchen.table_height_m + BUTTON_M / 2.0) }
    };
    let agent = alone.unwrap_or(Agent::Human);
    let those = of(agent).iter().filter(|button| is_shared(agent, button) == alone.is_none());
    EntityData::Solids(those.map(solid).collect(), alone.map_or(entity_content::BUTTON, entity_content::agent_colour))
}
