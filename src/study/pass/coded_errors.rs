//! The causes of a person's errors, from the consensus of two raters, from both raters' codes, or from the belief
//! estimate.

use tomcom_core::kitchen::Kitchen;
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::{ErrorCause, FalseBeliefTarget};
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::raters::{CodableErrors, ErrorCauseCode, ErrorCauseKind, RaterCodes};
use tomcom_core::measures::raters::{RaterChoice, RaterPair};
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::follower::SessionFollower;
use tomcom_session::log::{LogReader, consensus_file, rater_codes};
use tomcom_session::settings::ParticipantKind;

/// Raters' codes of the errors of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CodedErrors {
    /// Codes of two raters: of those whom the user named or who settled a consensus, else of the two who coded most
    /// errors. `None` with fewer than two raters, or if it is ambiguous which two.
    pub raters: Option<RaterPair>,
    /// Consensus codes of the two raters, if the codes hold and cover every error.
    pub consensus: Option<RaterCodes>,
    /// The two raters who settled the consensus.
    pub settled_by: Option<[String; 2]>,
    /// Why the raters' consensus does not hold; `None` if it holds, or if there is no consensus.
    pub stale: Option<String>,
}

impl CodedErrors {
    /// Reads the codes beside a log. `named`: the two raters whose codes shall be used, if the user names them.
    ///
    /// # Errors
    /// A file with codes is damaged; or more than two raters have coded every error of a person, and the user did not
    /// name two of these raters.
    pub fn read(log: &LogReader, follower: &SessionFollower, named: Option<&[String; 2]>) -> FileResult<CodedErrors> {
        let codable = CodableErrors::from_presses(&follower.session.kitchen, &follower.judged);
        let all = rater_codes::read_all(log.folder(), &codable)?;
        let own_codes = || -> FileResult<Option<RaterPair>> {
            let choice = named.map_or_else(
                || RaterChoice::most_complete(&all),
                |raters| RaterChoice::Pair(RaterPair::named(&all, raters)),
            );
            match choice {
                RaterChoice::Pair(pair) => Ok(Some(pair)),
                RaterChoice::Tied { raters, coded } if is_needed(follower, &codable, coded) => Err(tied(log, &raters)),
                RaterChoice::TooFew | RaterChoice::Tied { .. } => Ok(None),
            }
        };
        let consensus = consensus_file::read(log.folder(), &codable)?;
        let is_asked = |raters: &[String; 2]| named.is_none_or(|named| named.iter().all(|one| raters.contains(one)));
        let Some(consensus) = consensus.filter(|consensus| is_asked(&consensus.raters)) else {
            return Ok(CodedErrors { raters: own_codes()?, ..CodedErrors::default() });
        };
        let pair = RaterPair::named(&all, &consensus.raters);
        let own = &pair.codes;
        if let Some(rater) = consensus.without_codes(own.each_ref()) {
            let stale = format!("there are no codes of {rater}");
            return Ok(CodedErrors { raters: own_codes()?, stale: Some(stale), ..CodedErrors::default() });
        }
        if let Some(changed) = consensus.changed(own.each_ref()).first() {
            let error = codable.errors.partition_point(|&press| press < changed.press) + 1;
            let [one, other] = &consensus.raters;
            let stale = format!(
                "{} changed the code of error {error} (press {}) after {one} and {other} had settled it",
                changed.rater, changed.press
            );
            return Ok(CodedErrors { raters: own_codes()?, stale: Some(stale), ..CodedErrors::default() });
        }
        let shared = consensus.current(own.each_ref());
        match codable.errors.iter().all(|press| shared.0.contains_key(press)) {
            true => Ok(CodedErrors {
                raters: Some(pair),
                consensus: Some(shared),
                settled_by: Some(consensus.raters),
                stale: None,
            }),
            false => Ok(CodedErrors { raters: own_codes()?, ..CodedErrors::default() }),
        }
    }

    /// Human presses with the causes of errors, and the source of the causes: recorded beliefs for simulated
    /// participants; for people the raters' consensus, the codes of two raters who both coded every error, or else the
    /// belief estimate. The source is `None` for a simulated participant without recorded beliefs.
    pub fn judged(
        &self,
        follower: &SessionFollower,
        by_estimate: Option<&[(u64, ErrorCause)]>,
    ) -> (Vec<JudgedPress>, Option<BeliefSource>) {
        let mut judged = follower.judged.clone();
        let Some(estimated) = by_estimate else {
            let is_known = judged.iter().all(|press| press.belief_known);
            return (judged, is_known.then_some(BeliefSource::Recorded));
        };
        let raters = self.complete_raters(&judged);
        let kitchen = &follower.session.kitchen;
        for press in judged.iter_mut().filter(|press| press.verdict.error) {
            press.cause = match (&self.consensus, raters) {
                (Some(shared), _) => shared.0.get(&press.seq).and_then(|code| cause(kitchen, press, code)),
                (None, Some(raters)) => agreed(kitchen, press, raters),
                (None, None) => estimated.iter().find(|(seq, _)| *seq == press.seq).map(|(_, cause)| *cause),
            };
        }
        let basis = match (&self.consensus, raters) {
            (Some(_), _) => BeliefSource::Consensus,
            (None, Some(_)) => BeliefSource::Raters,
            (None, None) => BeliefSource::Estimate,
        };
        (judged, Some(basis))
    }

    /// Codes that two raters share: their consensus, or else errors that both coded alike, if both coded every error.
    pub fn shared(&self, judged: &[JudgedPress]) -> Option<RaterCodes> {
        let alike = || self.complete_raters(judged).map(|[one, other]| one.agreed(other));
        self.consensus.clone().or_else(alike)
    }

    /// The codes of the two raters; `None` unless both coded every error.
    fn complete_raters(&self, judged: &[JudgedPress]) -> Option<&[RaterCodes; 2]> {
        let coded =
            |codes: &RaterCodes| judged.iter().all(|press| !press.verdict.error || codes.0.contains_key(&press.seq));
        self.raters.as_ref().map(|pair| &pair.codes).filter(|codes| codes.iter().all(coded))
    }
}

/// Whether the causes of this trial's errors are determined by raters who each coded this many errors.
fn is_needed(follower: &SessionFollower, codable: &CodableErrors, coded: usize) -> bool {
    let is_person = follower.session.spec.participant.kind != ParticipantKind::Simulated;
    is_person && !codable.errors.is_empty() && coded == codable.errors.len()
}

fn tied(log: &LogReader, raters: &[String]) -> FileError {
    let found = format!("complete codes of {} raters: {}", raters.len(), raters.join(", "));
    let remedy = format!(
        "--raters with two of them, such as --raters {} {}; or a consensus of two of them (tomcom replay RECORDING \
         --settle)",
        raters[0], raters[1]
    );
    FileError::from_finding(log.folder(), found, remedy)
}

/// The cause of an error that a rater's code stands for.
fn cause(kitchen: &Kitchen, press: &JudgedPress, code: &ErrorCauseCode) -> Option<ErrorCause> {
    if code.kind() != ErrorCauseKind::Belief {
        return Some(ErrorCause::Slip);
    }
    Some(ErrorCause::Belief { gain_nats: f64::NAN, target: code.target(kitchen, press.before)?, with: None })
}

/// The cause of an error by two raters, whatever the raters' order. If both raters coded a false belief, the error
/// follows from a false belief; if they name two different ones, the first in the layout's order comes first. Otherwise
/// the error does not count as following from a false belief.
fn agreed(kitchen: &Kitchen, press: &JudgedPress, [one, other]: &[RaterCodes; 2]) -> Option<ErrorCause> {
    let codes = [one.0.get(&press.seq)?, other.0.get(&press.seq)?];
    if codes.iter().any(|code| code.kind() != ErrorCauseKind::Belief) {
        return Some(ErrorCause::Slip);
    }
    let mut targets: Vec<FalseBeliefTarget> =
        codes.iter().filter_map(|code| code.target(kitchen, press.before)).collect();
    targets.sort_by_key(|target| target.aspects(kitchen).next());
    targets.dedup();
    Some(ErrorCause::Belief { gain_nats: f64::NAN, target: *targets.first()?, with: targets.get(1).copied() })
}
