//! Table of participants, with the measures that are compared between their trials.

use crate::column::{CsvColumn, CsvRow, CsvTable};
use crate::effect::{StudyMeasure, TrialPair, pairs};
use crate::recorded_consent::RecordedConsent;
use crate::tables::trials::{HEADLINE, measures};
use crate::trial_statistics::TrialStatistics;

/// A participant with the participant's trials (at least one), and the first consent, if a consent is recorded.
#[derive(Clone, Copy, Debug)]
pub struct ParticipantRow<'a>(&'a [TrialStatistics], Option<&'a RecordedConsent>);

/// Participants of these trials, which must be ordered by participant, with their consents, which must be ordered by
/// time.
pub fn participants<'a>(
    trials: &'a [TrialStatistics],
    consents: &'a [RecordedConsent],
) -> impl Iterator<Item = ParticipantRow<'a>> {
    trials.chunk_by(|a, b| a.participant == b.participant).map(|of_one| {
        ParticipantRow(of_one, consents.iter().find(|consent| consent.participant == of_one[0].participant))
    })
}

impl ParticipantRow<'_> {
    /// The participant's compared pair of trials for a measure; `None` unless two trials of the participant count and
    /// have the measure.
    fn pair(&self, measure: StudyMeasure) -> Option<TrialPair> {
        pairs(self.0, measure).pairs.pop()
    }
}

impl CsvRow for ParticipantRow<'_> {
    const TABLE: CsvTable = CsvTable::Participants;

    fn columns() -> Vec<CsvColumn<Self>> {
        let code = "participant code; prefixed by the seed if several seeds are analysed together";
        let kind = "kind of participant: simulated, keyboard (at the console) or display (at the wall display)";
        let group = "starting group in the study plan; AB: conditions in the plan's order";
        let second = "whether the second trial is the assisted one; empty without a pair of trials that count";
        let mut columns: Vec<CsvColumn<Self>> = vec![
            Self::column("participant", "", code, |row| (&row.0[0].participant).into()),
            Self::column("kind", "", kind, |row| row.0[0].kind_name().into()),
            Self::column("group", "", group, |row| row.0[0].group.as_ref().into()),
            Self::column("trials", "trials", "number of recorded trials", |row| (row.0.len() as u64).into()),
            Self::column("trials_counted", "trials", "number of trials that are not left out", |row| {
                (row.0.iter().filter(|trial| trial.counts()).count() as u64).into()
            }),
            Self::column("assisted_second", "", second, |row| {
                row.pair(HEADLINE).map(|pair| pair.assisted_second).into()
            }),
        ];
        for measure in measures() {
            for (index, period) in ["first", "second"].into_iter().enumerate() {
                let name = format!("{}_{}", measure.name, index + 1);
                let meaning = measure.meaning_in.replace("{}", period);
                columns.push(Self::column(name, measure.unit, meaning, move |row| {
                    row.pair(measure).map(|pair| pair.values[index]).into()
                }));
            }
        }
        let on = "where consent was given: held on the display, or confirmed by the wizard on the console; empty: not recorded";
        let at = "wall clock time (UTC) at which the recording that begins with the consent began";
        let digest = "digest of the text that was agreed to, as the recording has it beside the text";
        columns.extend([
            Self::column("consent_on", "", on, |row| row.1.map(RecordedConsent::place).into()),
            Self::column("consent_at", "", at, |row| row.1.and_then(|consent| consent.started.as_ref()).into()),
            Self::column("consent_digest", "", digest, |row| row.1.map(|consent| &consent.digest).into()),
        ]);
        columns
    }
}
