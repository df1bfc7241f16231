//! Preparation of a session: new, repeated, or continued after a cut.

use std::path::PathBuf;
use std::sync::Arc;

use super::error::LiveError;
use super::options::SessionStart;
use super::resume::resume;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::engine::SessionEngine;
use tomcom_session::log::RecordingLock;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::watcher::SenderComparisonSettings;
use tomcom_session::{LogHeader, SessionSpec, TimestampedEvent};

/// A session that is prepared to be run and recorded.
pub(super) struct PreparedSession {
    pub engine: SessionEngine,
    pub header: LogHeader,
    /// First events of the new recording, which exist before the session runs.
    pub first: Vec<TimestampedEvent>,
    /// The participant's consent, if it was asked for just before the session.
    pub consent: Option<ProtocolEvent>,
    /// Session time at which the session begins.
    pub time: SessionTime,
    /// Comparison of wizard and assistants, if the console shows it.
    pub compare: Option<SenderComparisonSettings>,
    pub place: RecordingPlace,
}

/// In which folder the recording's folder is created.
pub(super) enum RecordingPlace {
    In(PathBuf),
    /// Beside the previous part of the recording, which stays locked.
    After(PathBuf, RecordingLock),
}

impl PreparedSession {
    /// Prepares a session; nothing is recorded yet.
    ///
    /// # Errors
    /// The recording that shall be continued cannot be continued.
    pub fn new(beginning: SessionStart) -> Result<PreparedSession, LiveError> {
        match beginning {
            SessionStart::New { files, trial, out } => {
                let kitchen = Arc::new(files.kitchen.kitchen);
                let spec = files.spec;
                let mut header = LogHeader::new(spec.clone(), trial, files.kitchen.layout, files.kitchen.recipes);
                header.keys = files.keys;
                let engine = SessionEngine::new(kitchen.clone(), spec, trial, CostToGo::new(kitchen)).without_causes();
                let (first, time, place) = (Vec::new(), SessionTime::ZERO, RecordingPlace::In(out));
                Ok(PreparedSession { engine, header, first, consent: None, time, compare: None, place })
            }
            SessionStart::Again { header, kitchen, out } => {
                let engine =
                    SessionEngine::for_header(kitchen.clone(), &header, CostToGo::new(kitchen)).without_causes();
                let (header, place) = (*header, RecordingPlace::In(out));
                Ok(PreparedSession {
                    engine,
                    header,
                    first: Vec::new(),
                    consent: None,
                    time: SessionTime::ZERO,
                    compare: None,
                    place,
                })
            }
            SessionStart::Continued(recording) => {
                let resumed = resume(&recording)?;
                let place = RecordingPlace::After(resumed.folder, resumed.lock);
                let (header, first, time) = (resumed.header, resumed.first, resumed.time);
                Ok(PreparedSession {
                    engine: resumed.engine.without_causes(),
                    header,
                    first,
                    consent: None,
                    time,
                    compare: None,
                    place,
                })
            }
        }
    }

    /// Adds to the prepared session the consent that the participant has just given.
    pub fn with_consent(self, consent: Option<ProtocolEvent>) -> PreparedSession {
        PreparedSession { consent, ..self }
    }

    /// Adds to the prepared session a comparison of wizard and assistants.
    pub fn comparing(self, compare: Option<SenderComparisonSettings>) -> PreparedSession {
        PreparedSession { compare, ..self }
    }

    /// The kitchen of the prepared session.
    pub fn kitchen(&self) -> &Kitchen {
        &self.engine.session().kitchen
    }

    /// Settings of the prepared session.
    pub fn spec(&self) -> &SessionSpec {
        &self.engine.session().spec
    }
}
