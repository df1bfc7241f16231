//! Freeze probes in a running session: begins probes when they are due, draws their questions, and lets a simulated
//! participant answer.

use super::SessionEngine;
use crate::Event;
use crate::probe_sampling::{aspect, questions};
use crate::probes::{DueProbeEvent, ProbeEvent, ProbeSubject, of_trial, upcoming};
use crate::wall_display::AnswerDevice;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::AspectId;
use tomcom_core::measures::sequences::FALSE_BELOW;

impl SessionEngine {
    /// Session time of the next event of a freeze probe.
    pub(super) fn probe_due(&self) -> Option<SessionTime> {
        let rule = upcoming(self.session()).map(|(due, _)| due);
        [rule, self.answer_due()].into_iter().flatten().min()
    }

    /// Session time at which the simulated participant answers the shown question.
    fn answer_due(&self) -> Option<SessionTime> {
        let (participant, session) = (self.participant.as_ref()?, self.session());
        let open = session.probes.open.as_ref().filter(|open| !open.is_paused())?;
        let (shown, _) = open.question()?;
        let after_s = participant.answers_after_s(open.number, shown as u32 + 1);
        Some(open.when(open.asked_at, SessionTime::from_secs_f64(after_s)).max(session.time))
    }

    /// Records the events of a freeze probe that are due. An answer at the last possible time still counts.
    pub(super) fn review_probe(&mut self, now: SessionTime) {
        loop {
            let rule = upcoming(self.session()).filter(|(due, _)| *due <= now);
            let answer = self.answer_due().filter(|due| *due <= now);
            match (rule, answer) {
                (Some((due, what)), answer) if answer.is_none_or(|answer| due < answer) => self.probe(now, what),
                (_, Some(_)) => self.let_participant_answer(now),
                _ => return,
            }
        }
    }

    fn probe(&mut self, now: SessionTime, what: DueProbeEvent) {
        let (probe, origin, uses_estimate) = match what {
            DueProbeEvent::Event(event) => return self.record_own(now, Event::Probe(event)),
            DueProbeEvent::Begin { probe, origin, uses_estimate } => (probe, origin, uses_estimate),
        };
        let is_wrong = uses_estimate.then(|| self.believed_wrong(now));
        let session = self.session();
        let Some(spec) = of_trial(&session.spec) else { return };
        let questions = questions(session, spec, probe, is_wrong.as_deref());
        if let Some(belief) = self.participant.as_ref().map(|one| one.believes(session.state)) {
            self.record_own(now, Event::ParticipantBelieves(belief));
        }
        self.record_own(now, Event::Probe(ProbeEvent::Begun { probe, origin, uses_estimate, questions }));
    }

    /// For each state aspect, whether the estimate says that the participant's belief about it is false now.
    fn believed_wrong(&mut self, now: SessionTime) -> Vec<bool> {
        let belief = self.follower.belief_at(now);
        let session = self.session();
        let is_wrong = |index| belief.p_truth(&session.kitchen, session.state, AspectId(index as u8)) < FALSE_BELOW;
        (0..session.kitchen.aspects.len()).map(is_wrong).collect()
    }

    fn let_participant_answer(&mut self, now: SessionTime) {
        let (Some(participant), session) = (&self.participant, self.session()) else { return };
        let Some(open) = &session.probes.open else { return };
        let Some((shown, asked)) = open.question() else { return };
        let (probe, question) = (open.number, shown as u32 + 1);
        let kitchen = &session.kitchen;
        let aspect = aspect(kitchen, &asked.about);
        let answer = match (&asked.about, aspect) {
            (_, Some(aspect)) => participant.answer(session.state, aspect, &asked.choices, (probe, question)),
            (ProbeSubject::NextOrder, _) => participant.next_order().map(|order| kitchen.location(order).name.clone()),
            // Simulated participants do not answer questions about the robot's next press, since they do not predict
            // the robot's presses.
            _ => None,
        };
        let asks_confidence = of_trial(&session.spec).is_some_and(|spec| spec.confidence);
        let confidence = aspect.filter(|_| asks_confidence && answer.is_some()).map(|one| participant.confidence(one));
        let on = AnswerDevice::Display;
        self.record_own(now, Event::Probe(ProbeEvent::Answered { probe, question, answer, confidence, on }));
    }
}
