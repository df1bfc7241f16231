//! Whose session the scene shows, and what its colours and clocks mean.

use super::entity_content::{EntityData, EntityUpdate};
use tomcom_session::Session;

/// Path of the page about the recording.
const PAGE: &str = "about";

/// The participant, the condition and what else tells recordings apart, each with its name.
pub fn facts(session: &Session) -> Vec<(&'static str, String)> {
    let spec = &session.spec;
    vec![
        ("participant", spec.participant.code.clone()),
        ("condition", spec.trial.condition.name().to_string()),
        ("study_arm", session.study_arm().title().to_string()),
        ("robot_arm", spec.robot.arm.name().to_string()),
        ("seed", spec.seed.to_string()),
    ]
}

/// "P07, wizard with advice (2026-03-14-P07-1)".
pub fn title(session: &Session, recording: &str) -> String {
    let (code, arm) = (&session.spec.participant.code, session.study_arm().title());
    if code.is_empty() { format!("{arm} ({recording})") } else { format!("{code}, {arm} ({recording})") }
}

/// The page in words.
pub fn page(session: &Session) -> EntityUpdate {
    let told = |(name, value): (&str, String)| match value.as_str() {
        "" => String::new(),
        value => format!("- {}: **{value}**\n", name.replace('_', " ")),
    };
    let facts: String = facts(session).into_iter().map(told).collect();
    EntityUpdate::new(PAGE, EntityData::Page(format!("{facts}\n{LEGEND}")))
}

const LEGEND: &str = "\
**Colours**, as on the console: errors red, estimated false beliefs yellow, signals, advice and the wizard violet, the human \
teal, the robot blue, gaze and looks green. What lies in a place is brown. Buttons of the robot are blue, of the human \
teal, of both red. A bar is grey where several are too close to be told apart: zoom in. Bars are of the whole trial, \
whatever the time; looks are drawn about the present time.

An **estimated false belief** is one by the assistant's estimate. A **false belief**, as in causes and hits, is the \
participant's own: only simulated participants record it.

**P(truth)**: lines are the estimate, at a press first that before it, then that after it; \u{25c6} is what a simulated \
participant believes itself before a press, crosses at 0 are errors. A line is of a belief that is wrong \
for a second: from when it turned wrong (drawn after that second) until it is known (95 %).

**Gaze**: the circle is the newest gaze with the area that can be read, large dots are the last 0.5 s, small ones the last \
1.5 s. Grey dots are uncertain: the eye tracker's confidence is too low, and the estimate does not use them.

**To a moment**: click a time in the list of what happened, press the right mouse button in the bars or curves, or drag in \
the line at the bottom. `+85.619s` is 1:25.6 on the trial's clock. In the bars, ctrl and the wheel zoom.
";
