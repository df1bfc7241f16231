//! The causes of a person's errors: by the consensus of two raters, by both raters' codes, or by the estimate.

use crate::analysis::follower::Follower;
use crate::edge::file_error::FileResult;
use crate::edge::log::{LogReader, consensus_file, rater_codes};
use crate::kitchen::Kitchen;
use crate::measures::JudgedPress;
use crate::measures::attribution::Cause;
use crate::measures::cause_codes::{CauseKind, Codable, Code, Codes, most_complete};
use crate::study::trial_statistics::BeliefBasis;

/// What raters say about the errors of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CodedErrors {
    /// Codes of two raters: of those who settled a consensus, else of the two who coded most errors; `None` with fewer than two.
    pub raters: Option<[Codes; 2]>,
    /// The consensus, if it holds and covers every error.
    pub consensus: Option<Codes>,
    /// The two raters of that consensus.
    pub settled_by: Option<[String; 2]>,
    /// Why there is a consensus that does not hold.
    pub stale: Option<String>,
}

impl CodedErrors {
    /// Reads the codes beside a log.
    ///
    /// # Errors
    /// A file with codes is damaged.
    pub fn read(log: &LogReader, follower: &Follower) -> FileResult<CodedErrors> {
        let codable = Codable::from_presses(&follower.session.kitchen, &follower.judged);
        let all = rater_codes::read_all(log.folder(), &codable)?;
        let Some(consensus) = consensus_file::read(log.folder(), &codable)? else {
            return Ok(CodedErrors { raters: most_complete(all.into_values().collect()), ..CodedErrors::default() });
        };
        let own = consensus.raters.each_ref().map(|rater| all.get(rater).cloned().unwrap_or_default());
        if let Some(changed) = consensus.changed(own.each_ref()).first() {
            let error = codable.errors.partition_point(|&press| press < changed.press) + 1;
            let [one, other] = &consensus.raters;
            let stale = format!(
                "{} changed the code of error {error} (press {}) after {one} and {other} settled it",
                changed.rater, changed.press
            );
            let raters = most_complete(all.into_values().collect());
            return Ok(CodedErrors { raters, stale: Some(stale), ..CodedErrors::default() });
        }
        let shared = consensus.current(own.each_ref());
        match codable.errors.iter().all(|press| shared.0.contains_key(press)) {
            true => Ok(CodedErrors {
                raters: Some(own),
                consensus: Some(shared),
                settled_by: Some(consensus.raters),
                stale: None,
            }),
            false => {
                let raters = most_complete(all.into_values().collect());
                Ok(CodedErrors { raters, ..CodedErrors::default() })
            }
        }
    }

    /// Human presses with the causes of errors, and the source of the causes: recorded beliefs for simulated participants; for people
    /// the raters' consensus, the codes of two raters who both coded every error, else the estimate. The source is `None` for a simulated
    /// participant without recorded beliefs.
    pub fn judged(
        &self,
        follower: &Follower,
        by_estimate: Option<&[(u64, Cause)]>,
    ) -> (Vec<JudgedPress>, Option<BeliefBasis>) {
        let mut judged = follower.judged.clone();
        let Some(estimated) = by_estimate else {
            let is_known = judged.iter().all(|press| press.belief_known);
            return (judged, is_known.then_some(BeliefBasis::Recorded));
        };
        let coded = |codes: &Codes| judged.iter().all(|press| !press.verdict.error || codes.0.contains_key(&press.seq));
        let raters = self.raters.as_ref().filter(|raters| raters.iter().all(coded));
        let kitchen = &follower.session.kitchen;
        for press in judged.iter_mut().filter(|press| press.verdict.error) {
            press.cause = match (&self.consensus, raters) {
                (Some(shared), _) => shared.0.get(&press.seq).and_then(|code| cause(kitchen, press, code)),
                (None, Some(raters)) => agreed(kitchen, press, raters),
                (None, None) => estimated.iter().find(|(seq, _)| *seq == press.seq).map(|(_, cause)| *cause),
            };
        }
        let basis = match (&self.consensus, raters) {
            (Some(_), _) => BeliefBasis::Consensus,
            (None, Some(_)) => BeliefBasis::Raters,
            (None, None) => BeliefBasis::Estimate,
        };
        (judged, Some(basis))
    }
}

/// The cause that a code names.
fn cause(kitchen: &Kitchen, press: &JudgedPress, code: &Code) -> Option<Cause> {
    if code.kind() != CauseKind::Belief {
        return Some(Cause::Slip);
    }
    Some(Cause::Belief { gain_nats: f64::NAN, target: code.target(kitchen, press.before)?, with: None })
}

/// The cause of an error by two raters. If both coded a false belief, the target is the first rater's; otherwise the error counts
/// as not belief related.
fn agreed(kitchen: &Kitchen, press: &JudgedPress, [one, other]: &[Codes; 2]) -> Option<Cause> {
    let (a, b) = (one.0.get(&press.seq)?, other.0.get(&press.seq)?);
    if b.kind() != CauseKind::Belief {
        return Some(Cause::Slip);
    }
    cause(kitchen, press, a)
}
