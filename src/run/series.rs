//! The loop over recordings: one recording is one run of at most one trial, and what a participant goes through is a
//! series of them, made at the same desk without leaving the console.

use super::desk::Desk;
use super::live::{self, Begun, LiveEnd, LiveError};
use super::options::Beginning;

/// Runs sessions at the console, one after another, until the wizard quits or none is left. What was recorded, in order.
///
/// # Errors
/// There is no terminal, a session cannot be recorded, or the gaze input cannot be opened.
pub fn operate(beginning: Beginning) -> Result<Vec<LiveEnd>, LiveError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(LiveError::Terminal)?;
    // Inside, since signals and sockets belong to the runtime.
    runtime.block_on(run(beginning))
}

async fn run(beginning: Beginning) -> Result<Vec<LiveEnd>, LiveError> {
    let mut done = Vec::new();
    let mut desk = None;
    let mut next = Some(beginning);
    while let Some(beginning) = next.take() {
        // Before the terminal is taken and a recording is made: a session that cannot start leaves nothing behind.
        let begun = Begun::new(beginning)?;
        let desk = match &mut desk {
            Some(desk) => desk,
            none => none.insert(Desk::take(&begun.spec().participant).await?),
        };
        let mut end = live::run(begun, desk).await?;
        next = end.again.take();
        done.push(end);
    }
    Ok(done)
}

/// What came of it, for people.
pub fn describe(done: &[LiveEnd]) -> String {
    done.iter().map(|end| format!("{}\n", end.describe())).collect()
}
