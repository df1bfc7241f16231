//! Filter of gaze datagrams by sender. A datagram identifies its sender only by the network address: the address that
//! sends the first sample keeps the gaze input to itself until it has been silent for a while.

use std::net::IpAddr;
use std::time::{Duration, Instant};

use tomcom_session::settings::GazeSenders;

/// Silence after which the network address that sent gaze loses its exclusive use of the gaze input.
pub const RELEASE: Duration = Duration::from_secs(5);

/// Which address may send gaze datagrams: the first sender has exclusive use until it falls silent.
#[derive(Clone, Copy, Debug)]
pub struct ExclusiveDatagramSender {
    senders: GazeSenders,
    /// Address with exclusive use of the gaze input, and the arrival of its last sample.
    holder: Option<(IpAddr, Instant)>,
}

impl ExclusiveDatagramSender {
    /// A filter that no address uses exclusively yet.
    pub fn new(senders: GazeSenders) -> ExclusiveDatagramSender {
        ExclusiveDatagramSender { senders, holder: None }
    }

    /// The other address because of which no gaze datagram from this network address is read; `None` if it is read.
    pub fn excludes(&self, from: IpAddr, now: Instant) -> Option<IpAddr> {
        let (holder, heard) = self.holder.filter(|_| self.senders == GazeSenders::First)?;
        (holder != from && now.saturating_duration_since(heard) < RELEASE).then_some(holder)
    }

    /// Records that a datagram from this network address contained a gaze sample.
    pub fn heard(&mut self, from: IpAddr, now: Instant) {
        self.holder = Some((from, now));
    }
}
