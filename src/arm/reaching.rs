//! Simulated motion of the human's hand between its resting place and the buttons: minimum-jerk reaches (Flash and
//! Hogan 1985). The hand follows the recorded presses and never delays a press, even if the hand is late or avoids the
//! arm; the hand is simulated so that the robot arm can meet it.

use nalgebra::Point3;
use rand::RngExt;
use tomcom_core::base::maths::eased;
use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, Kitchen};

use crate::physics::CYCLE_S;
use crate::physics::bodies::HandPose;

/// Duration of a reach of the hand in seconds: a constant part, and a part per metre of the reach.
const REACH_S: f64 = 0.3;
const REACH_S_M: f64 = 0.8;
/// Height by which the hand is lifted in the middle of a reach, in metres.
const LIFTED_M: f64 = 0.04;
/// Offset of the hand's centre behind the pressed button, and its height above the table, in metres (the hand is a ball
/// without fingers).
const FINGER_M: f64 = 0.02;
const PRESSES_M: f64 = 0.05;
/// Resting place of the hand: distance behind the last button and height above the table, in metres.
const BEYOND_M: f64 = 0.16;
const RESTS_M: f64 = 0.08;
/// Distance that an attentive hand keeps from the robot arm, in metres, and time after which the hand gives up a
/// blocked reach, in seconds.
const KEEPS_OFF_M: f64 = 0.06;
const GIVES_UP_S: f64 = 1.5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReachingBehaviour {
    /// Time for which the hand stays at a button after a press, in seconds.
    pub lingers_s: f64,
    /// Share of reaches in which the person does not watch the robot arm.
    pub heedless: f64,
}

impl ReachingBehaviour {
    /// Hand motion of simulated participants. The share of heedless reaches is an estimate.
    pub const SIMULATED: ReachingBehaviour = ReachingBehaviour { lingers_s: 0.3, heedless: 0.005 };
    /// Hand motion assumed for real people, whose hands are not tracked: the hand stays at the last pressed button for
    /// a while, and never moves into the robot arm.
    pub const UNSEEN: ReachingBehaviour = ReachingBehaviour { lingers_s: 1.5, heedless: 0.0 };
}

#[derive(Clone, Copy, Debug)]
struct Way {
    from_m: Point3<f64>,
    to_m: Point3<f64>,
    done_s: f64,
    takes_s: f64,
    held_up_s: f64,
    /// Height by which the hand is lifted in the middle, in metres.
    lifted_m: f64,
    /// Whether the movement is a press, after which the hand returns.
    presses: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Planned {
    to_m: Point3<f64>,
    begins: SessionTime,
}

/// The simulated hand of the human, which reaches for buttons.
#[derive(Clone, Debug)]
pub struct ReachingHand {
    how: ReachingBehaviour,
    random: Stream,
    table_m: f64,
    rests_m: Point3<f64>,
    at_m: Point3<f64>,
    way: Option<Way>,
    planned: Option<Planned>,
    /// Target position of the hand's present or last reach.
    goal_m: Option<Point3<f64>>,
    /// The time at which the hand returns from a button after a press.
    leaves: Option<SessionTime>,
    heedless: bool,
}

/// The resting place of the hand in the frame of the robot arm's base: before the human's buttons.
pub fn resting_place(kitchen: &Kitchen) -> Point3<f64> {
    let buttons = &kitchen.buttons[Agent::Human.index()];
    let furthest_m = buttons.iter().map(|button| button.at_m[0]).fold(0.0, f64::max);
    Point3::new(furthest_m + BEYOND_M, 0.0, kitchen.table_height_m + RESTS_M)
}

impl ReachingHand {
    /// A hand at rest before the human's buttons.
    pub fn new(kitchen: &Kitchen, how: ReachingBehaviour, random: Stream) -> ReachingHand {
        let (table_m, rests_m) = (kitchen.table_height_m, resting_place(kitchen));
        ReachingHand {
            how,
            random,
            table_m,
            rests_m,
            at_m: rests_m,
            way: None,
            planned: None,
            goal_m: None,
            leaves: None,
            heedless: false,
        }
    }

    /// The centre of a hand whose finger is on a button.
    fn on(&self, [x, y]: [f64; 2]) -> Point3<f64> {
        Point3::new(x + FINGER_M, y, self.table_m + PRESSES_M)
    }

    fn takes_s(&self, to_m: &Point3<f64>) -> f64 {
        REACH_S + REACH_S_M * (to_m - self.at_m).norm()
    }

    /// Starts or plans a reach: the person intends to press the button at this position on the table at the time `at`,
    /// as far as the time is known now.
    pub fn means(&mut self, now: SessionTime, button_m: [f64; 2], at: SessionTime) {
        let to_m = self.on(button_m);
        let is_on_its_way = self.way.is_some_and(|way| way.presses && way.to_m == to_m);
        if is_on_its_way || (self.way.is_none() && self.at_m == to_m && self.leaves.is_none()) {
            return;
        }
        let begins = (at - SessionTime::from_secs_f64(self.takes_s(&to_m))).max(now);
        self.planned = Some(Planned { to_m, begins });
    }

    /// Ends a reach: the person has pressed the button at this position on the table.
    pub fn pressed(&mut self, now: SessionTime, button_m: [f64; 2]) {
        let to_m = self.on(button_m);
        self.planned = None;
        let lingers = SessionTime::from_secs_f64(self.how.lingers_s);
        match self.way.filter(|way| way.presses && way.to_m == to_m) {
            // A hand that arrives late at the button turns back when it arrives.
            Some(_) => {}
            None if self.at_m == to_m => self.leaves = Some(now + lingers),
            None => self.reach(to_m),
        }
    }

    /// Reacts to a contact: the person withdraws the hand, and watches the robot arm from now on.
    pub(crate) fn feels_the_arm(&mut self) {
        self.heedless = false;
        if self.way.is_none_or(|way| way.presses) {
            (self.planned, self.leaves) = (None, None);
            self.set_out(self.rests_m, LIFTED_M, false);
        }
    }

    fn reach(&mut self, to_m: Point3<f64>) {
        if self.goal_m != Some(to_m) {
            self.heedless = self.random.random::<f64>() < self.how.heedless;
        }
        self.goal_m = Some(to_m);
        self.leaves = None;
        self.set_out(to_m, LIFTED_M, true);
    }

    fn set_out(&mut self, to_m: Point3<f64>, lifted_m: f64, presses: bool) {
        let takes_s = self.takes_s(&to_m);
        self.way = Some(Way { from_m: self.at_m, to_m, done_s: 0.0, takes_s, held_up_s: 0.0, lifted_m, presses });
    }

    pub fn place(&self) -> HandPose {
        self.at(self.at_m)
    }

    fn at(&self, at_m: Point3<f64>) -> HandPose {
        HandPose::reaching(at_m, self.table_m)
    }

    /// The time of the hand's next movement after `since`.
    pub fn next_move(&self, since: SessionTime) -> Option<SessionTime> {
        let cycle = since + SessionTime::from_secs_f64(CYCLE_S);
        if self.way.is_some() {
            return Some(cycle);
        }
        let begins = self.planned.map(|planned| planned.begins);
        begins.into_iter().chain(self.leaves).min().map(|time| time.max(cycle))
    }

    /// Moves the hand for the controller cycle that ends now. `distance_m` computes the distance between a hand pose
    /// and the robot arm.
    pub fn cycle(&mut self, now: SessionTime, distance_m: impl Fn(&HandPose) -> f64) {
        if let Some(planned) = self.planned.take_if(|planned| planned.begins <= now) {
            self.reach(planned.to_m);
        }
        if self.leaves.take_if(|leaves| *leaves <= now).is_some() {
            self.set_out(self.rests_m, LIFTED_M, false);
        }
        let Some(mut way) = self.way else { return };
        let share = ((way.done_s + CYCLE_S) / way.takes_s).min(1.0);
        let eased = eased(share);
        let mut next_m = way.from_m + (way.to_m - way.from_m) * eased;
        next_m.z += way.lifted_m * 4.0 * eased * (1.0 - eased);
        let off_m = distance_m(&self.at(next_m));
        let keeps_off = !self.heedless && off_m < KEEPS_OFF_M && off_m < distance_m(&self.place());
        if keeps_off {
            way.held_up_s += CYCLE_S;
        } else {
            way.done_s += CYCLE_S;
            self.at_m = if share < 1.0 { next_m } else { way.to_m };
        }
        let is_over = share >= 1.0 && !keeps_off || way.held_up_s > GIVES_UP_S;
        self.way = Some(way).filter(|_| !is_over);
        if is_over && way.presses {
            self.leaves = Some(now + SessionTime::from_secs_f64(self.how.lingers_s));
        } else if is_over && self.at_m != self.rests_m {
            // Below an arm, a hand that is lifted comes nearer to it. Such a hand draws back as it lies, along its forearm,
            // and then goes to its resting place: it never stays where both wait for each other.
            match way.lifted_m > 0.0 {
                true => self.set_out(Point3::new(self.rests_m.x, self.at_m.y, self.at_m.z), 0.0, false),
                false => self.set_out(self.rests_m, LIFTED_M, false),
            }
        }
    }

    pub fn postpone(&mut self, by: SessionTime) {
        if let Some(planned) = &mut self.planned {
            planned.begins = planned.begins + by;
        }
        self.leaves = self.leaves.map(|leaves| leaves + by);
    }
}
