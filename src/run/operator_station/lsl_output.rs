//! The Lab Streaming Layer (LSL) at the operator's station: its library, and the streams that are sent.

use std::rc::Rc;

use tomcom_devices::lsl::{self, LslError, LslLibrary, LslStreams, describe};
use tomcom_session::{Session, SessionSpec};

/// The LSL library, if the session uses LSL, and the streams that are sent. A participant's streams stay open from one
/// recording to the next, so that a recorder can continue.
#[derive(Default)]
pub(in crate::run) struct LslOutput {
    /// `None` if the session does not use LSL.
    pub library: Option<LslLibrary>,
    streams: Option<Rc<LslStreams>>,
}

impl LslOutput {
    /// Loads the LSL library, if the session uses LSL.
    ///
    /// # Errors
    /// The LSL library is missing, or too old.
    pub fn open(spec: &SessionSpec) -> Result<LslOutput, LslError> {
        let library = spec.uses_lsl().then(|| lsl::load(spec.lsl.as_ref())).transpose()?;
        Ok(LslOutput { library, streams: None })
    }

    /// The LSL streams that this session sends; `None` if it sends none.
    ///
    /// # Errors
    /// The LSL library cannot open the streams.
    pub fn streams(&mut self, session: &Session) -> Result<Option<Rc<LslStreams>>, LslError> {
        let wanted = describe(&session.spec, &session.kitchen);
        let Some(library) = self.library.filter(|_| !wanted.is_empty()) else { return Ok(None) };
        if let Some(streams) = self.streams.as_ref().filter(|streams| streams.descriptions == wanted) {
            return Ok(Some(streams.clone()));
        }
        // The previous participant's LSL streams end before new ones are opened.
        self.streams = None;
        self.streams = Some(Rc::new(LslStreams::offer(library, wanted)?));
        Ok(self.streams.clone())
    }
}
