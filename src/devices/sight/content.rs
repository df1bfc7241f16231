//! What changes on the participant's display: stage, contents, presses and their effects, signals, questions.

use serde::Serialize;

use super::displayed_item::{DisplayedQuestionnaireItem, SceneElement, question, spot};
use super::probe_page::{DisplayedProbe, probe, probe_left};
use super::tutorial_page::{DisplayedTutorial, RecipeCard, card, tutorial};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::{Agent, ButtonId, ContentId, Kitchen, LocationId, LocationKind, OrderContent, State};
use tomcom_core::robot::{IdleReason, SafetyMode};
use tomcom_session::gaze_check::RunningGazeCheck;
use tomcom_session::plan::{PhaseSpec, StudyPhase, TutorialStep, TutorialStepKind};
use tomcom_session::wall_display::RobotDepiction;
use tomcom_session::{Session, TimelineEvent, TrialPhase, proposals};

/// Everything that changes on the participant's display; each update is complete.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayContent {
    pub stage: DisplayStage,
    pub practice: bool,
    /// What each location shows, in the order of [`super::DisplayScene::locations`]; empty during a freeze probe.
    pub contents: Vec<ShownContent>,
    /// Number of orders served in this trial, if the session shows this number.
    pub served: Option<usize>,
    /// Whether the trial's clock goes, if the session shows the clock. The message to the page has the time that is
    /// left.
    pub clock: Option<TrialClockState>,
    /// Last press of the human and last press of the robot, by [`Agent::index`].
    pub presses: [Option<DisplayedPress>; 2],
    /// Location or storage where the robot is about to press, if the session shows the robot's intention.
    pub intention: Option<SceneElement>,
    /// What the robot does, if that is not simply its work.
    pub robot_does: Option<RobotActivity>,
    pub signal: Option<DisplayedSignal>,
    /// Number of the newest event that is marked by a flash.
    pub cue: Option<u64>,
    pub question: Option<DisplayedQuestionnaireItem>,
    pub tutorial: Option<DisplayedTutorial>,
    pub probe: Option<DisplayedProbe>,
    /// Target for the eyes while the gaze is checked, in fractions of the display.
    pub target: Option<[f64; 2]>,
    /// Whether the accuracy of the gaze is being checked, in which case the display shows nothing else.
    pub checks: bool,
}

/// Stage of the session, such as instruction, trial or questionnaire, which decides which page the participant's
/// display shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DisplayStage {
    Welcome,
    Instruction,
    Tutorial,
    TutorialOver,
    Ready,
    Running,
    Paused,
    /// A freeze probe is open: the trial stands still, and the participant is asked what they believe.
    Probe,
    Over,
    Questionnaire,
    Answered,
    /// A questionnaire is answered, and another one follows.
    MoreQuestions,
    /// The participant is thanked, in the debriefing and after the session's end.
    Thanks,
}

/// What the robot does instead of simply working, as the participant's display says it; the page has a text for each.
/// Which press of the human would help is not told, since that would be a proposal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RobotActivity {
    WaitsHuman,
    WaitsOrder,
    /// For a while, whatever the human does: somebody holds it, or it leaves out what it would press.
    Waits,
    /// It moves at reduced speed, for safety.
    Slow,
    /// Until the wizard releases it.
    Stopped,
}

/// Content that a location shows on the participant's display.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ShownContent {
    Empty,
    Item(String),
    /// A stack of items, by the items' names; a stack that is a dish of the menu is shown as that dish.
    Stack(Vec<String>),
    /// A dish, by the dish's name: ordered, or finished at a location.
    Dish(String),
    /// An order that was served a moment ago.
    Served,
}

/// A press and its effect, as the participant's display shows them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct DisplayedPress {
    pub number: u32,
    pub at: SceneElement,
    pub effective: bool,
    /// Why the human's press had no effect, if the session shows reasons.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<DisplayedNoEffectReason>,
}

/// Reason why a press had no effect, as the participant's display shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct DisplayedNoEffectReason {
    /// The reason why the press had no effect; the page has a text for each reason.
    pub reason: NoEffectReason,
    /// The location that the reason is about, by its index in the scene.
    pub about: usize,
}

/// A signal on the participant's display.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DisplayedSignal {
    Recipe {
        /// The order's location, by its index in the scene.
        order: usize,
        dish: String,
        items: Vec<String>,
    },
    /// A signal that highlights a location, given by its index in the scene.
    Highlight(usize),
    /// Proposed presses that the participant has not made yet, the next press first, by the indices of the buttons in
    /// [`super::DisplayScene::buttons`].
    Next(Vec<usize>),
}

/// Creates the changing part of the participant's display in a session.
pub fn sight(session: &Session) -> DisplayContent {
    let kitchen = &session.kitchen;
    let practised = session.tutorial_step();
    let state = practised.map_or(session.state, |(_, tutorial)| tutorial.kitchen);
    let contents = (0..kitchen.locations.len()).map(|index| shown(kitchen, state, LocationId(index as u8)));
    let probe = probe(session);
    let is_trial = probe.is_none() && matches!(session.phase, TrialPhase::Running | TrialPhase::Paused);
    let intention = session.robot.intention.filter(|_| session.spec.display.intention && is_trial);
    let stage = if probe.is_some() { DisplayStage::Probe } else { stage(session) };
    DisplayContent {
        stage,
        practice: matches!(session.study_phase(), Some(PhaseSpec::Familiarisation)),
        contents: contents.filter(|_| probe.is_none()).collect(),
        served: session.spec.display.served.then_some(session.served.len()),
        clock: clock(session, stage),
        presses: Agent::BOTH.map(|agent| match practised.is_some() {
            true => practised_press(session).filter(|_| agent == Agent::Human),
            false => pressed(session, agent),
        }),
        intention: intention
            .map(|(button, ..)| spot(kitchen, Agent::Robot, kitchen.button(Agent::Robot, button).action)),
        robot_does: robot_does(session).filter(|_| is_trial),
        signal: match practised {
            Some((step, tutorial)) => explained(kitchen, tutorial.kitchen, step),
            None if probe.is_some() => None,
            None => proposed(session)
                .or_else(|| session.shown.as_ref().and_then(|shown| told(kitchen, session.state, &shown.signal))),
        },
        cue: session.cue,
        question: question(session),
        tutorial: tutorial(session),
        probe,
        target: session.calibration.as_ref().and_then(RunningGazeCheck::target),
        checks: session.calibration.as_ref().is_some_and(|check| check.result.is_none()),
    }
}

/// What the robot does, if that is not simply its work. Where the display shows no robot, a real one is seen, and the
/// display says only that it is stopped.
fn robot_does(session: &Session) -> Option<RobotActivity> {
    let robot = &session.robot;
    if robot.stopped {
        return Some(RobotActivity::Stopped);
    }
    if session.spec.display.arm == RobotDepiction::None {
        return None;
    }
    // Nothing is said about hands, for which it slows or waits: nobody measures them, and the page's places are not
    // those of the robot's table.
    let is_blocked = robot.intention.is_some() && robot.arm.mode == SafetyMode::Safeguard;
    match robot.idle.as_ref().map(|(reason, _)| reason) {
        _ if robot.held && robot.driven_to.is_none() || is_blocked => Some(RobotActivity::Waits),
        Some(IdleReason::HumanTurn) => Some(RobotActivity::WaitsHuman),
        Some(IdleReason::NoOrder) => Some(RobotActivity::WaitsOrder),
        Some(IdleReason::Skipped) => Some(RobotActivity::Waits),
        // In a pause the arm rests.
        None if robot.arm.mode == SafetyMode::Reduced && session.is_running() => Some(RobotActivity::Slow),
        None => None,
    }
}

/// The trial's clock, if the session shows the clock and there is a trial (a tutorial is none). During a probe, the
/// display shows the time that the probe still has instead.
fn clock(session: &Session, stage: DisplayStage) -> Option<TrialClockState> {
    if !session.spec.display.clock || session.tutorial().is_some() {
        return None;
    }
    match stage {
        DisplayStage::Running => Some(TrialClockState::Goes),
        DisplayStage::Ready | DisplayStage::Paused | DisplayStage::Over => Some(TrialClockState::Stands),
        _ => None,
    }
}

fn stage(session: &Session) -> DisplayStage {
    let trial = match session.phase {
        TrialPhase::Ready => DisplayStage::Ready,
        TrialPhase::Running => DisplayStage::Running,
        TrialPhase::Paused => DisplayStage::Paused,
        TrialPhase::Over(_) => DisplayStage::Over,
        TrialPhase::Closed if is_to_come_back(session) => return DisplayStage::Over,
        TrialPhase::Closed => return DisplayStage::Thanks,
    };
    match (session.protocol.is_some(), session.study_phase()) {
        (false, _) if trial == DisplayStage::Ready => DisplayStage::Welcome,
        (false, _) | (true, Some(PhaseSpec::Trial | PhaseSpec::Familiarisation)) => trial,
        (true, None) => DisplayStage::Welcome,
        (true, Some(PhaseSpec::Instruction { .. })) => DisplayStage::Instruction,
        // Whatever follows a tutorial, or nothing: the page promises no trial.
        (true, Some(PhaseSpec::Tutorial { .. })) if session.tutorial_step().is_none() => DisplayStage::TutorialOver,
        (true, Some(PhaseSpec::Tutorial { .. })) => DisplayStage::Tutorial,
        (true, Some(PhaseSpec::Questionnaire { .. })) => {
            let is_confirmed = session.protocol.as_ref().is_some_and(|protocol| protocol.confirmed);
            match session.next_phase() {
                _ if !is_confirmed => DisplayStage::Questionnaire,
                Some(StudyPhase::Questionnaire) => DisplayStage::MoreQuestions,
                _ => DisplayStage::Answered,
            }
        }
        (true, Some(PhaseSpec::Debriefing { .. })) => DisplayStage::Thanks,
    }
}

/// Whether the plan has more for the participant of a session that is closed: another trial, or the rest of this one.
fn is_to_come_back(session: &Session) -> bool {
    let Some((step, _)) = session.step() else { return false };
    let is_debriefed = matches!(session.study_phase(), Some(PhaseSpec::Debriefing { .. }));
    step.period != Some(step.periods) || session.aborted.is_some() || session.ended_early && !is_debriefed
}

pub(super) fn shown(kitchen: &Kitchen, state: State, location: LocationId) -> ShownContent {
    if kitchen.location(location).kind == LocationKind::Order {
        return match state.order(location) {
            OrderContent::None => ShownContent::Empty,
            OrderContent::Served => ShownContent::Served,
            OrderContent::Dish(dish) => ShownContent::Dish(kitchen.dish(dish).name.clone()),
        };
    }
    content(kitchen, state.content(location))
}

fn content(kitchen: &Kitchen, id: ContentId) -> ShownContent {
    let content = kitchen.content(id);
    let names = || content.items.iter().map(|item| kitchen.content(*item).name.clone()).collect();
    match content.items.len() {
        0 => ShownContent::Empty,
        1 => ShownContent::Item(content.name.clone()),
        _ if kitchen.dishes.iter().any(|dish| dish.stack() == id) => ShownContent::Dish(content.name.clone()),
        _ => ShownContent::Stack(names()),
    }
}

fn pressed(session: &Session, agent: Agent) -> Option<DisplayedPress> {
    let newest = session.timeline.iter().rev().find_map(|entry| match entry.what {
        TimelineEvent::Press { agent: by, button, no_effect, .. } if by == agent => Some((button, no_effect)),
        _ => None,
    });
    let (button, no_effect) = newest?;
    let at = spot(&session.kitchen, agent, session.kitchen.button(agent, button).action);
    let is_told = agent == Agent::Human && session.spec.display.reasons;
    let effective = no_effect.is_none();
    let why =
        no_effect.filter(|_| is_told).map(|(reason, about)| DisplayedNoEffectReason { reason, about: about.index() });
    Some(DisplayedPress { number: session.presses[agent.index()], at, effective, why })
}

/// The last press that the participant made in the present step of the tutorial.
fn practised_press(session: &Session) -> Option<DisplayedPress> {
    let (_, tutorial) = session.tutorial_step()?;
    let press = tutorial.last?;
    let at = spot(&session.kitchen, Agent::Human, session.kitchen.button(Agent::Human, press.button).action);
    let is_told = session.spec.display.reasons;
    let why = press.no_effect.filter(|_| is_told);
    let why = why.map(|(reason, about)| DisplayedNoEffectReason { reason, about: about.index() });
    Some(DisplayedPress { number: press.number, at, effective: press.is_right, why })
}

fn explained(kitchen: &Kitchen, state: State, step: &TutorialStep) -> Option<DisplayedSignal> {
    if step.kind != TutorialStepKind::Signal {
        return None;
    }
    let order = || Some(Signal::ShowRecipe(kitchen.location(*kitchen.orders.first()?).name.clone()));
    let signal = step.highlight.clone().map(Signal::Highlight).or_else(order)?;
    told(kitchen, state, &signal)
}

/// Centre of the location or storage where the robot presses a button, in fractions of the display.
pub(super) fn button_place(session: &Session, button: ButtonId) -> [f64; 2] {
    let kitchen = &session.kitchen;
    match spot(kitchen, Agent::Robot, kitchen.button(Agent::Robot, button).action) {
        SceneElement::Location(index) => kitchen.locations[index].display.centre(),
        SceneElement::Storage(index) => kitchen.storages[index].display.centre(),
    }
}

/// The proposed presses that the display shows; `None` if no proposal is shown.
fn proposed(session: &Session) -> Option<DisplayedSignal> {
    let button = |name: &String| session.kitchen.button_named(Agent::Human, name).map(ButtonId::index);
    Some(DisplayedSignal::Next(proposals::left(session)?.iter().filter_map(button).collect()))
}

fn told(kitchen: &Kitchen, state: State, signal: &Signal) -> Option<DisplayedSignal> {
    let location = signal.location(kitchen)?;
    match signal {
        Signal::Propose(_) => None,
        Signal::Highlight(_) => Some(DisplayedSignal::Highlight(location.index())),
        Signal::ShowRecipe(_) => {
            let OrderContent::Dish(dish) = state.order(location) else { return None };
            let RecipeCard { dish, items } = card(kitchen, dish);
            Some(DisplayedSignal::Recipe { order: location.index(), dish, items })
        }
    }
}

/// Whether the trial's clock on the display goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialClockState {
    Goes,
    /// The trial's clock stands still: before the trial, in a pause, and at the end.
    Stands,
}

/// The time left that the page shows at `now`: the time that an open probe still has, or else the time that the trial
/// still has, if the display shows the trial's clock.
pub fn time_left(session: &Session, now: SessionTime) -> Option<SessionTime> {
    let of_trial = || {
        let limit = SessionTime::from_secs_f64(session.spec.trial.seconds);
        let passed = session.trial_clock(now);
        session.spec.display.clock.then(|| SessionTime(limit.0.saturating_sub(passed.0)))
    };
    probe_left(session, now).or_else(of_trial)
}
