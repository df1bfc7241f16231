//! Filter of gaze datagrams by sender. A datagram identifies its sender only by the network address: the address that
//! sends the first sample keeps the gaze input to itself until it has been silent for a while.

use std::net::IpAddr;
use std::time::{Duration, Instant};

use crate::session::settings::GazeSenders;

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

    /// Whether a gaze datagram from this network address is read.
    pub fn admits(&self, from: IpAddr, now: Instant) -> bool {
        match (self.senders, self.holder) {
            (GazeSenders::Any, _) | (_, None) => true,
            (GazeSenders::First, Some((holder, heard))) => {
                holder == from || now.saturating_duration_since(heard) >= RELEASE
            }
        }
    }

    /// Records that a datagram from this network address contained a gaze sample.
    pub fn heard(&mut self, from: IpAddr, now: Instant) {
        self.holder = Some((from, now));
    }
}
