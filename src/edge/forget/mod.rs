//! The command `tomcom forget`: finds and deletes everything about one participant (or one wizard) below a folder:
//! recordings with what this program wrote beside their logs, rows of tables, reports, streams, training records.
//!
//! Only files that say that this program wrote them are deleted or changed: recordings say it in their headers, tables
//! by their columns, reports and streams in their first bytes, training records by their fields. The participant is
//! looked for in the column or field that means the participant or the recording. A file that may contain data of the
//! participant, but does not say so, is kept, and listed with the reason.

mod deletion;
mod owner;
mod participant_data;
mod participant_rows;
mod subject;
mod walk;

pub use self::deletion::{ParticipantDeletionError, delete};
pub use self::participant_data::{ParticipantData, find};
pub use self::walk::RetainedFile;
