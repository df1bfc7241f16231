//! Lanes with the questions and answers of freeze probes.

use super::entity_content::{self, EntityData, EntityUpdate, SceneLogLevel, slug};
use tomcom_core::kitchen::Agent;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_session::history::wording;
use tomcom_session::probes::{ProbeEvent, ProbeQuestion, ProbeSubject};
use tomcom_session::{Session, probe_sampling};

/// Path of the lane with the question that is being asked.
const ASKED: &str = "human/probes/asked";
/// Path of the text log of the participant's answers.
const SAID: &str = "human/answers";

/// State of the lanes that show freeze probes.
#[derive(Clone, Debug, Default)]
pub struct ProbeScene {
    /// Lanes that contain text. Answers stay in their lanes until the next probe begins, since the trial's clock stands
    /// still during a probe.
    filled: Vec<String>,
}

impl ProbeScene {
    /// Entity updates from an event that has just been applied to the session; `belief` is the estimate after the
    /// event.
    pub fn follow(
        &mut self,
        session: &Session,
        event: &ProbeEvent,
        belief: Option<&DirichletBelief>,
    ) -> Vec<EntityUpdate> {
        let question = |number: u32| {
            let open = session.probes.open.as_ref()?;
            open.questions.get((number as usize).checked_sub(1)?)
        };
        match event {
            ProbeEvent::Begun { .. } => self.filled.drain(..).map(|lane| state(lane, "")).collect(),
            ProbeEvent::Asked { question: number, .. } => {
                let asked = question(*number).map_or_else(String::new, |asked| wording::probe_subject(&asked.about));
                vec![state(ASKED, asked)]
            }
            ProbeEvent::Answered { question: number, answer, .. } => {
                let Some(asked) = question(*number) else { return Vec::new() };
                self.answered(session, asked, answer.as_deref(), belief)
            }
            ProbeEvent::Closed { .. } => vec![state(ASKED, "")],
            _ => Vec::new(),
        }
    }

    fn answered(
        &mut self,
        session: &Session,
        asked: &ProbeQuestion,
        answer: Option<&str>,
        belief: Option<&DirichletBelief>,
    ) -> Vec<EntityUpdate> {
        let about = wording::probe_subject(&asked.about);
        let said = match (answer, &asked.about) {
            (None, _) => "does not know".to_string(),
            (Some(name), ProbeSubject::Location { .. } | ProbeSubject::Recipe { .. }) => {
                session.kitchen.worded(name).to_string()
            }
            (Some(name), ProbeSubject::NextOrder | ProbeSubject::NextPress) => wording::location(name),
        };
        let estimate = probe_sampling::aspect(&session.kitchen, &asked.about).zip(belief).map(|(aspect, belief)| {
            let (held, values) = (&belief.aspects[aspect.index()], &session.kitchen.aspects[aspect.index()]);
            let value = held.most_likely();
            format!("{} {:.0} %", values.wordings[value], 100.0 * held.mean()[value])
        });
        let beside = estimate.as_ref().map_or_else(String::new, |estimate| format!(" (estimate: {estimate})"));
        let text = format!("human answers, {about}: {said}{beside}");
        let line =
            EntityData::Words { level: SceneLogLevel::Info, text, colour: entity_content::agent_colour(Agent::Human) };
        let lane = |kind: &str| format!("human/probes/{}_{kind}", slug(&about));
        let mut rows = vec![EntityUpdate::new(SAID, line)];
        for (kind, text) in [("answer", Some(said)), ("estimate", estimate)] {
            if let Some(text) = text {
                self.filled.push(lane(kind));
                rows.push(state(lane(kind), text));
            }
        }
        rows
    }
}

fn state(entity: impl Into<String>, text: impl Into<String>) -> EntityUpdate {
    EntityUpdate::new(entity, EntityData::State(text.into(), entity_content::HUMAN))
}
