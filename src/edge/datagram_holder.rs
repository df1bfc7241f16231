//! Filter of gaze datagrams by sender. A datagram identifies its sender by nothing but the address: the address that sends the
//! first sample holds the input until it has been silent for a while.

use std::net::IpAddr;
use std::time::{Duration, Instant};

use crate::session::settings::GazeSenders;

/// Silence after which the holder loses the input.
pub const RELEASE: Duration = Duration::from_secs(5);

/// The address that holds the datagram input.
#[derive(Clone, Copy, Debug)]
pub struct DatagramHolder {
    senders: GazeSenders,
    /// The holder and the arrival of its last sample.
    holder: Option<(IpAddr, Instant)>,
}

impl DatagramHolder {
    /// An input without a holder.
    pub fn new(senders: GazeSenders) -> DatagramHolder {
        DatagramHolder { senders, holder: None }
    }

    /// Whether a datagram from this address is read.
    pub fn admits(&self, from: IpAddr, now: Instant) -> bool {
        match (self.senders, self.holder) {
            (GazeSenders::Any, _) | (_, None) => true,
            (GazeSenders::First, Some((holder, heard))) => {
                holder == from || now.saturating_duration_since(heard) >= RELEASE
            }
        }
    }

    /// Notes that a datagram from this address contained a sample.
    pub fn heard(&mut self, from: IpAddr, now: Instant) {
        self.holder = Some((from, now));
    }
}
