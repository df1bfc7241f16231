//! The operator's station: terminal, eye tracker, the participant's display and button box, a real arm, and termination signals. The station is opened
//! once for all recordings of a participant's series.

use std::io;
use std::net::SocketAddr;
use std::path::Path;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::mpsc::{Receiver, Sender};
use tokio::sync::oneshot;
use tokio::time::timeout;

use super::error::{LiveError, TerminalError};
use super::recorded_films::RecordedFilms;
use crate::console::ConsoleMessage;
use crate::console::preflight::GazePairing;
use crate::console::view::theme::Theme;
use crate::run::event_loop::{LoopEvent, ShellView};
use crate::run::terminal::{JobControl, TerminalScreen, asked_to_end, outlive_file_limits, theme};
use crate::run::terminal_input::TerminalInput;
use tomcom_core::kitchen::Kitchen;
use tomcom_devices::gaze_file::{self, GazeFile};
use tomcom_devices::gaze_input::TrackerMessage;
use tomcom_devices::gaze_json;
use tomcom_devices::lsl::{self, LslError, LslThreadGuard};
use tomcom_devices::pupil::{self, CaptureConfiguration, CaptureRequest};
use tomcom_session::SessionSpec;
use tomcom_session::gaze_check::AcceptedGazeCheck;
use tomcom_session::settings::{ConsoleSpec, GazeSource};

/// Largest number of tracker messages that are processed together; more would delay the wizard's keys.
const PACKET: usize = 32;
/// Longest wait for the signal that continued the program.
const CONTINUED: Duration = Duration::from_millis(200);
/// Longest wait for the program Pupil Capture to finish its last request.
const LAST_REQUEST: Duration = Duration::from_secs(2);

mod lsl_output;
#[cfg(feature = "ur")]
mod station_arm;
mod station_button_box;
#[cfg(feature = "display")]
mod station_display;
#[cfg(feature = "display")]
mod station_observers;

#[cfg(not(feature = "ur"))]
pub(super) use super::missing_features::arm::{ArmNews, ArmOrders, StationArm};
#[cfg(not(feature = "display"))]
pub(super) use super::missing_features::display::{
    PageInput, Remark, StationDisplay, StationObservers, lost_since, take_consent_input,
};
use lsl_output::LslOutput;
#[cfg(feature = "ur")]
pub(super) use station_arm::{ArmNews, ArmOrders, StationArm};
use station_button_box::StationButtonBox;
#[cfg(feature = "display")]
pub(super) use station_display::{PageInput, StationDisplay, lost_since, take_consent_input};
#[cfg(feature = "display")]
pub(super) use station_observers::{Remark, StationObservers};

/// Terminal and devices that all recordings of a series share.
pub(super) struct OperatorStation {
    pub screen: TerminalScreen,
    /// Colour theme of the questions that the console asks before a recording.
    pub theme: Theme,
    pub input: OperatorInput,
    pub tracker: GazeTracker,
    pub display: StationDisplay,
    pub button_box: StationButtonBox,
    pub observers: StationObservers,
    pub arm: StationArm,
    pub lsl: LslOutput,
    /// Films of recordings that are over.
    pub films: RecordedFilms,
}

/// The wizard's input from the terminal, and termination signals from the system.
pub(super) struct OperatorInput {
    terminal: TerminalInput,
    jobs: JobControl,
    end: Pin<Box<dyn Future<Output = io::Result<()>>>>,
}

/// External gaze source: an eye tracker, a stream or a file.
#[derive(Default)]
pub(super) struct GazeTracker {
    news: Option<Receiver<TrackerMessage>>,
    /// Channel for requests to the program Pupil Capture; `None` if it is not the tracker.
    pub orders: Option<Sender<CaptureRequest>>,
    /// End of the thread that reads gaze from the Lab Streaming Layer; the station waits for it once `news` is dropped.
    _inlet: Option<LslThreadGuard>,
    /// The file from which gaze is replayed; `None` if gaze comes from another source.
    pub file: Option<Arc<GazeFile>>,
    /// Pairing codes for gaze senders at other computers; `None` if senders need no pairing.
    pub pairing: Option<GazePairing>,
    /// Latest connection state of the tracker, which recordings that begin later are told.
    link: Option<TrackerMessage>,
    sees_display: Option<TrackerMessage>,
    other_surfaces: Option<TrackerMessage>,
    several_streams: Option<TrackerMessage>,
    stamps: Option<TrackerMessage>,
    /// Last gaze accuracy check that the wizard accepted.
    pub calibrated: Option<AcceptedGazeCheck>,
}

impl OperatorStation {
    /// Opens the devices that these settings need, and takes over the terminal. With `observe`, the wizard's screen can be
    /// watched at this address.
    ///
    /// # Errors
    /// There is no terminal, a port cannot be opened, a gaze file cannot be read, the tags do not fit on the display, or
    /// the library of the Lab Streaming Layer is missing.
    pub async fn take(
        spec: &SessionSpec,
        kitchen: &Kitchen,
        observe: Option<SocketAddr>,
    ) -> Result<OperatorStation, LiveError> {
        outlive_file_limits().map_err(TerminalError)?;
        let lsl = LslOutput::open(spec)?;
        let tracker = GazeTracker::open(spec, kitchen, &lsl).await?;
        let display = StationDisplay::open(spec).await?;
        let observers = StationObservers::open(observe).await?;
        let arm = StationArm::open(spec, kitchen)?;
        let button_box = StationButtonBox::open(spec, kitchen);
        let bare = OperatorStation::without_devices(&spec.console)?;
        Ok(OperatorStation { tracker, display, button_box, observers, arm, lsl, ..bare })
    }

    /// Takes over the terminal, without devices.
    ///
    /// # Errors
    /// There is no terminal.
    pub fn without_devices(console: &ConsoleSpec) -> Result<OperatorStation, TerminalError> {
        let screen = TerminalScreen::take().map_err(TerminalError)?;
        let theme = theme(console, screen.ground);
        let terminal = TerminalInput::start().map_err(TerminalError)?;
        let jobs = JobControl::start().map_err(TerminalError)?;
        let input = OperatorInput { terminal, jobs, end: Box::pin(asked_to_end()) };
        let (tracker, display, lsl) = (GazeTracker::default(), StationDisplay::default(), LslOutput::default());
        let (button_box, observers) = (StationButtonBox::default(), StationObservers::default());
        let (arm, films) = (StationArm::default(), RecordedFilms::default());
        Ok(OperatorStation { screen, theme, input, tracker, display, button_box, observers, arm, lsl, films })
    }

    /// Draws this in the terminal, and shows it to the observers.
    ///
    /// # Errors
    /// The terminal's size is unknown.
    pub fn draw(&mut self, view: &ShellView<'_>) -> Result<(), TerminalError> {
        if let Some(drawn) = self.screen.draw(view).map_err(TerminalError)? {
            let theme = match *view {
                ShellView::Console(_, model) => model.theme,
                ShellView::Question(.., theme) | ShellView::Recordings(_, theme) => theme,
            };
            self.observers.show(&drawn, theme);
        }
        Ok(())
    }

    /// Sets the terminal up again after the program was stopped; with `stops`, gives the terminal back and stops the
    /// program first.
    ///
    /// # Errors
    /// The terminal was closed meanwhile.
    pub async fn set_up_again(&mut self, stops: bool) -> Result<(), TerminalError> {
        if stops {
            TerminalScreen::stop_program().map_err(TerminalError)?;
            // The signal by which the shell continued the program is this one's, and no further one.
            let _ = timeout(CONTINUED, self.input.jobs.next()).await;
        }
        self.screen.set_up_again().map_err(TerminalError)
    }
}

impl OperatorInput {
    /// What was typed, clicked and pasted before the shell that now begins was on the screen is dropped: it was meant for
    /// another one. Returns what holds for every shell: the terminal's size and focus.
    pub fn forget_keys(&mut self) -> Vec<ConsoleMessage> {
        let is_state =
            |message: &ConsoleMessage| matches!(message, ConsoleMessage::Focus(_) | ConsoleMessage::Resized(..));
        self.terminal.waiting().into_iter().filter(is_state).collect()
    }

    /// Waits for the wizard's next input, or for a signal; the program has to end also if the terminal was closed.
    pub async fn next(&mut self) -> LoopEvent {
        tokio::select! {
            biased;
            _ = &mut self.end => LoopEvent::EndRequest,
            signal = self.jobs.next() => signal,
            message = self.terminal.next() => message.map_or(LoopEvent::EndRequest, LoopEvent::Terminal),
        }
    }
}

impl GazeTracker {
    async fn open(spec: &SessionSpec, kitchen: &Kitchen, lsl: &LslOutput) -> Result<GazeTracker, LiveError> {
        let (participant, tracker) = (&spec.participant, &spec.tracker);
        let surface = || tracker.surface_map(kitchen).map_err(LiveError::Tags);
        match participant.gaze {
            GazeSource::Json => {
                let at = SocketAddr::new(participant.gaze_listen, participant.gaze_port);
                let listener = gaze_json::listen(at, participant.gaze_senders, &participant.gaze_from).await;
                let listener = listener.map_err(|reason| LiveError::Gaze { at, reason })?;
                let address = listener.reachable().to_string();
                let pairing = listener.code.map(|code| GazePairing { address, code });
                Ok(GazeTracker { news: Some(listener.news), pairing, ..GazeTracker::default() })
            }
            GazeSource::Pupil => {
                let (address, surface_name) = (tracker.address.clone(), tracker.surface.clone());
                let (port, records) = (tracker.port, tracker.record);
                let capture = CaptureConfiguration { address, port, surface: surface_name, map: surface()?, records };
                let (news, orders) = pupil::follow(capture);
                Ok(GazeTracker { news: Some(news), orders: Some(orders), ..GazeTracker::default() })
            }
            GazeSource::File => {
                let path = tracker.file.as_deref().unwrap_or_default();
                let file = Arc::new(gaze_file::read(Path::new(path), &surface()?, tracker)?);
                Ok(GazeTracker { file: Some(file), ..GazeTracker::default() })
            }
            GazeSource::Lsl => {
                let stream = spec.lsl.as_ref().and_then(|spec| spec.gaze.clone());
                // The settings were checked, so both the LSL library and the stream's settings exist.
                let Some((library, stream)) = lsl.library.zip(stream) else { return Ok(GazeTracker::default()) };
                let followed = lsl::follow(library, stream, kitchen.display_m);
                let (news, inlet) = followed.map_err(|_| LslError::NoThread)?;
                Ok(GazeTracker { news: Some(news), _inlet: Some(inlet), ..GazeTracker::default() })
            }
            GazeSource::Simulated | GazeSource::Mouse | GazeSource::None => Ok(GazeTracker::default()),
        }
    }

    /// Waits for the next tracker messages (samples arrive in packets); waits forever if there is no tracker.
    pub async fn next(&mut self) -> Option<Vec<TrackerMessage>> {
        let Some(news) = &mut self.news else { return std::future::pending().await };
        let mut packet = Vec::new();
        // All pending messages are received in one call, so that none is lost if another branch of the event loop is
        // selected meanwhile.
        news.recv_many(&mut packet, PACKET).await;
        packet.iter().for_each(|news| self.know(news));
        (!packet.is_empty()).then_some(packet)
    }

    fn know(&mut self, news: &TrackerMessage) {
        match news {
            TrackerMessage::Connected(_) => self.link = Some(news.clone()),
            TrackerMessage::Lost(_) => {
                (self.link, self.sees_display, self.other_surfaces) = (Some(news.clone()), None, None);
            }
            TrackerMessage::SeesDisplay(_) => (self.sees_display, self.other_surfaces) = (Some(news.clone()), None),
            TrackerMessage::OtherSurfaces(_) => self.other_surfaces = Some(news.clone()),
            TrackerMessage::SeveralStreams(_) => self.several_streams = Some(news.clone()),
            TrackerMessage::Stamps(_) => self.stamps = Some(news.clone()),
            _ => {}
        }
    }

    /// Messages with the tracker's present state, for a recording that begins now.
    pub fn known(&self) -> impl Iterator<Item = TrackerMessage> {
        let known = self.link.iter().chain(&self.sees_display).chain(&self.other_surfaces);
        known.chain(&self.several_streams).chain(&self.stamps).cloned()
    }

    /// Waits briefly until the program Pupil Capture has finished its requests.
    pub async fn finish_requests(&self) {
        let Some(orders) = self.orders.as_ref().filter(|_| matches!(self.link, Some(TrackerMessage::Connected(_))))
        else {
            return;
        };
        let (sender, done) = oneshot::channel();
        if orders.try_send(CaptureRequest::Report(sender)).is_ok() {
            // The wait is limited, since Pupil Capture may have been closed.
            let _ = timeout(LAST_REQUEST, done).await;
        }
    }
}
