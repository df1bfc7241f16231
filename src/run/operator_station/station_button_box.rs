//! The participant's button box at the operator's station.

use tokio::sync::mpsc::Receiver;
use tomcom_core::kitchen::Kitchen;
use tomcom_devices::button_box::{self, ButtonBoxMessage};
use tomcom_session::SessionSpec;

/// The button box, if the session has one.
#[derive(Default)]
pub(in crate::run) struct StationButtonBox {
    news: Option<Receiver<ButtonBoxMessage>>,
    /// The message that says whether the box is there, for a recording that begins later.
    pub link: Option<ButtonBoxMessage>,
}

impl StationButtonBox {
    pub fn open(spec: &SessionSpec, kitchen: &Kitchen) -> StationButtonBox {
        let path = spec.participant.button_box.as_ref();
        StationButtonBox { news: path.map(|path| button_box::follow(path, kitchen)), link: None }
    }

    /// Waits for what the box tells next; waits forever if there is none.
    pub async fn next(&mut self) -> Option<ButtonBoxMessage> {
        let Some(news) = &mut self.news else { return std::future::pending().await };
        let message = news.recv().await?;
        if matches!(message, ButtonBoxMessage::Connected | ButtonBoxMessage::Lost(_)) {
            self.link = Some(message.clone());
        }
        Some(message)
    }
}
