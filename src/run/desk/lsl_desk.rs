//! The Lab Streaming Layer at the desk: its library, and the streams that are offered to recorders.

use std::rc::Rc;

use crate::analysis::lsl::describe;
use crate::edge::lsl::{self, LslError, LslLibrary, LslStreams};
use crate::session::{Session, SessionSpec};

/// The library, if the session uses it, and the streams that are offered. Those of a participant stay the same from one recording to
/// the next, so that a recorder reads on.
#[derive(Default)]
pub(in crate::run) struct LslDesk {
    library: Option<LslLibrary>,
    streams: Option<Rc<LslStreams>>,
}

impl LslDesk {
    /// Loads the library, if the session uses it.
    ///
    /// # Errors
    /// There is none, or it is too old.
    pub fn open(spec: &SessionSpec) -> Result<LslDesk, LslError> {
        let library = spec.uses_lsl().then(|| lsl::load(spec.lsl.as_ref())).transpose()?;
        Ok(LslDesk { library, streams: None })
    }

    /// The library, if the session uses it.
    pub fn library(&self) -> Option<LslLibrary> {
        self.library
    }

    /// The streams of this session; `None` if it sends none.
    ///
    /// # Errors
    /// The library does not offer them.
    pub fn streams(&mut self, session: &Session) -> Result<Option<Rc<LslStreams>>, LslError> {
        let wanted = describe(&session.spec, &session.kitchen);
        let Some(library) = self.library.filter(|_| !wanted.is_empty()) else { return Ok(None) };
        if let Some(streams) = self.streams.as_ref().filter(|streams| streams.descriptions == wanted) {
            return Ok(Some(streams.clone()));
        }
        // Those of another participant end first.
        self.streams = None;
        self.streams = Some(Rc::new(LslStreams::offer(library, wanted)?));
        Ok(self.streams.clone())
    }
}
