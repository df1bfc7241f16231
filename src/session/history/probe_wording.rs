//! Wording of freeze probes: questions, answers and events as texts.

use crate::probes::{ProbeEvent, ProbeOrigin, ProbeSubject};
use tomcom_core::base::text::count;

/// A name from the log as words on a screen, without underscores.
fn said(name: &str) -> String {
    name.replace('_', " ")
}

/// The state aspect that a question of a freeze probe is about, in words: "cutting board", "recipe of tuna maki".
pub fn subject(about: &ProbeSubject) -> String {
    match about {
        ProbeSubject::Location { location } => said(location),
        ProbeSubject::Recipe { dish } => format!("recipe of {}", said(dish)),
        ProbeSubject::NextOrder => "the order that is served next".to_string(),
        ProbeSubject::NextPress => "the robot's next press".to_string(),
    }
}

/// An event of a freeze probe in words.
pub fn event(event: &ProbeEvent) -> String {
    match event {
        ProbeEvent::Requested => "the wizard requests a freeze probe".to_string(),
        ProbeEvent::Delayed { probe, reason } => format!("freeze probe {probe} is delayed: {}", reason.words()),
        ProbeEvent::Dropped { probe, reason } => format!("freeze probe {probe} is dropped: {}", reason.words()),
        ProbeEvent::Begun { probe, origin, questions, .. } => {
            let by = match origin {
                ProbeOrigin::Schedule => "",
                ProbeOrigin::Wizard => ", at the wizard's request",
            };
            let about: Vec<String> = questions.iter().map(|question| subject(&question.about)).collect();
            let questions = count(questions.len() as u64, "question", "questions");
            format!("freeze probe {probe} begins{by}: the task stands still, {questions}: {}", about.join(", "))
        }
        ProbeEvent::Asked { probe, question } => format!("freeze probe {probe} asks question {question}"),
        ProbeEvent::Answered { question, answer: Some(answer), confidence, .. } => {
            let sure = confidence.map_or(String::new(), |step| format!(" (confidence {step} of 3)"));
            format!("answer to probe question {question}: {}{sure}", said(answer))
        }
        ProbeEvent::Answered { question, answer: None, .. } => {
            format!("answer to probe question {question}: I don't know")
        }
        ProbeEvent::Skipped { probe, reason } => {
            format!("the wizard skips the other questions of freeze probe {probe}: {reason}")
        }
        ProbeEvent::Closed { probe, reason } => format!("freeze probe {probe} closes: {}", reason.words()),
        ProbeEvent::Ended { probe } => format!("the task continues after freeze probe {probe}"),
    }
}
