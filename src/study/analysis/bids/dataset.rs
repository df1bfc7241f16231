//! Files at the root of a BIDS data set.

use serde_json::json;

use super::tsv::{self, BidsColumn, BidsFile, or_nothing};

/// Name of the file that describes the BIDS data set.
pub const DESCRIPTION_NAME: &str = "dataset_description.json";
/// Name of the file with the table of participants.
pub const PARTICIPANTS_NAME: &str = "participants.tsv";
/// Name of the column with the participants' codes in the table of participants.
pub const CODE_COLUMN: &str = "code";
/// Program that the description of the BIDS data set names as its generator.
pub const PROGRAM_NAME: &str = "tomcom";
/// Version of BIDS that the data set follows; BIDS has eye-tracking data since 1.10.
const BIDS_VERSION: &str = "1.10.1";

const KINDS: &[(&str, &str)] = &[
    ("simulated", "A simulated participant"),
    ("keyboard", "A person at the keyboard of the console"),
    ("display", "A person at the participant's display"),
];

const CONSENTS: &[(&str, &str)] = &[
    ("console", "Told to the wizard, who confirmed it on the console"),
    ("display", "The participant held a button on the display"),
];

const COLUMNS: [BidsColumn; 8] = [
    BidsColumn::new("participant_id", "The participant: sub- and the letters and digits of the code"),
    BidsColumn::new(CODE_COLUMN, "The participant's code in the recordings"),
    BidsColumn::of_levels("kind", KINDS, "Who took part"),
    BidsColumn::new("group", "Starting group of the plan: the order of conditions"),
    BidsColumn::new("recordings", "Number of recordings"),
    BidsColumn::of_levels("consent_on", CONSENTS, "Where consent was given"),
    BidsColumn::new("consent_at", "Wall clock time (UTC) at which the recording that begins with the consent began"),
    BidsColumn::new("consent_digest", "Digest of the text that was agreed to"),
];

/// A participant of a BIDS data set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BidsParticipant {
    /// The participant's label in file and folder names of the data set.
    pub label: String,
    /// The participant's code in the recordings.
    pub code: String,
    /// Kind of participant (person or simulation), as the log names it.
    pub kind: String,
    /// The participant's starting group, if there is a study plan.
    pub group: Option<String>,
    /// Number of the participant's recordings in the data set.
    pub recordings: usize,
    /// The participant's consent, as far as a recording says it: where it was given, when, and the digest of its text.
    pub consent: [Option<String>; 3],
}

/// The files at the root of the data set: its description, the table of participants, a README. `plans`: the names of
/// the studies' plans.
pub fn dataset_files(plans: &[String], participants: &[BidsParticipant], with_words: bool) -> Vec<BidsFile> {
    let name = if plans.is_empty() { "tomcom recordings".to_string() } else { plans.join(", ") };
    let description = json!({
        "Name": name,
        "BIDSVersion": BIDS_VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [{
            "Name": PROGRAM_NAME,
            "Version": env!("CARGO_PKG_VERSION"),
            "Description": "tomcom export --bids",
        }],
    });
    let row = |one: &BidsParticipant| {
        let label = format!("sub-{}", one.label);
        let group = or_nothing(one.group.as_deref());
        let [on, at, digest] = one.consent.each_ref().map(|cell| or_nothing(cell.as_deref()));
        tsv::line([label, one.code.clone(), one.kind.clone(), group, one.recordings.to_string(), on, at, digest])
    };
    let rows: String = participants.iter().map(row).collect();
    vec![
        BidsFile::json(DESCRIPTION_NAME, &description),
        BidsFile::new(PARTICIPANTS_NAME, tsv::line(tsv::names(&COLUMNS)) + &rows),
        BidsFile::json("participants.json", &tsv::described(&COLUMNS).into()),
        BidsFile::new("README.md", readme(&name, participants.len(), with_words)),
    ]
}

fn readme(name: &str, participants: usize, with_words: bool) -> String {
    let words = match with_words {
        true => {
            "What wizards and participants typed (notes, reasons, answers in words) is in the column `words` and in `phenotype/`."
        }
        false => "What wizards and participants typed (notes, reasons, answers in words) is left out.",
    };
    format!(
        "# {name}\n\n\
         Recordings of people or simulated people who cook together with a robot, made with tomcom, and exported by `tomcom export --bids`. \
         Participants: {participants}.\n\n\
         A recording is a session (`ses-`). `sub-*_sessions.tsv` says under which condition it was made, whether it is practice, and \
         whether it is left out of the analysis.\n\n\
         - `*_events.tsv`: one row for each event of the recording's log but samples. Times are session time: seconds since the \
         beginning of the recording.\n\
         - `*_recording-eye1_physio.tsv.gz`: gaze, one row for each sample; `*_physioevents.tsv.gz`: fixations and blinks, as the eye \
         tracker found them. `recording-pointer`: a mouse pointer that stands in for gaze.\n\
         - `*_recording-arm_stim.tsv.gz`: the motion of the robot's arm. It is sampled while the arm moves, so intervals differ.\n\
         - `*_beh.tsv`: what simulated participants believed, and the estimates of beliefs.\n\
         - `phenotype/`: questionnaires. `_2` is the second time that participants answered one.\n\n\
         Rows of events, gaze, fixations and blinks, and arm together are as many as the log has events; `seq` is the number of the event in \
         it. {words}\n\n\
         To be filled in before the data set is published: authors, license and ethics in `dataset_description.json`.\n"
    )
}
