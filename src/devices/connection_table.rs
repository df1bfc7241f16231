//! Table of a server's open network connections. The table limits their number, in total and per address. A new
//! connection beyond a limit replaces the one that was silent longest, so that silent connections cannot keep others
//! out.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tokio::sync::watch;

use crate::lock;

/// Limits for the numbers of open connections of a server.
#[derive(Clone, Copy, Debug)]
pub struct ConnectionLimits {
    /// Largest number of open connections. The sum of this limit over all servers of the program stays well below 1024,
    /// a usual limit of open files.
    pub most: usize,
    /// Largest number of open network connections per address.
    pub per_address: usize,
    /// Largest number of admitted network connections (whose sender has been identified).
    pub admitted: usize,
    /// Largest number of admitted connections per address. Keeping it below [`Self::per_address`] leaves room for new
    /// connections.
    pub admitted_per_address: usize,
    /// Silence after which an admitted connection may be replaced by a new one, if no connection is waiting for
    /// admission.
    pub silence: Duration,
}

/// How a connection is treated when there are too many connections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ConnectionStanding {
    /// The connection's sender is not identified yet: a new connection may replace this connection.
    Waiting,
    /// The connection's sender is identified as a page or a tracker: the connection is replaced only after a silence.
    Admitted,
    /// The connection is reserved: it is never replaced, and not counted by the limits of admitted connections.
    Reserved,
}

#[derive(Debug)]
struct ConnectionEntry {
    number: u64,
    address: IpAddr,
    standing: ConnectionStanding,
    heard: Instant,
    close: watch::Sender<bool>,
}

#[derive(Debug, Default)]
struct ConnectionEntries {
    entries: Vec<ConnectionEntry>,
    next: u64,
}

/// Open network connections of one server.
#[derive(Debug)]
pub struct ConnectionTable {
    limits: ConnectionLimits,
    inner: Mutex<ConnectionEntries>,
}

/// An open connection's entry in the table; dropping it removes the entry.
#[derive(Debug)]
pub struct ConnectionHandle {
    pub number: u64,
    /// Network address of the connection's other end, as the limits count addresses; see [`network_of`].
    pub address: IpAddr,
    table: Arc<ConnectionTable>,
    closing: watch::Receiver<bool>,
}

/// A new connection, and whether another connection is closed to make room for it.
#[derive(Debug)]
pub struct NewConnection {
    pub place: ConnectionHandle,
    pub made_room: bool,
}

impl ConnectionTable {
    /// A table of network connections without entries.
    pub fn new(limits: ConnectionLimits) -> Arc<ConnectionTable> {
        Arc::new(ConnectionTable { limits, inner: Mutex::default() })
    }

    /// Adds a connection from this address. Beyond a limit the new connection replaces the one that was silent longest:
    /// one of the same address if that address has too many, else one of the address with the most waiting connections.
    /// `None` if no connection can be replaced, so that the new one has to be refused.
    pub fn arrive(self: &Arc<Self>, address: IpAddr, now: Instant) -> Option<NewConnection> {
        let address = network_of(address);
        let mut inner = lock(&self.inner);
        let of_address = inner.entries.iter().filter(|entry| entry.address == address).count();
        let is_full = of_address >= self.limits.per_address || inner.entries.len() >= self.limits.most;
        if is_full {
            let only = (of_address >= self.limits.per_address).then_some(address);
            let index = self.replaceable(&inner.entries, only, now)?;
            inner.entries.remove(index).close.send_replace(true);
        }
        let number = inner.next;
        inner.next += 1;
        let (close, closing) = watch::channel(false);
        let standing = ConnectionStanding::Waiting;
        inner.entries.push(ConnectionEntry { number, address, standing, heard: now, close });
        let place = ConnectionHandle { number, address, table: self.clone(), closing };
        Some(NewConnection { place, made_room: is_full })
    }

    /// Index of the connection that a new one may replace, among connections of the address `only` or among all.
    fn replaceable(&self, entries: &[ConnectionEntry], only: Option<IpAddr>, now: Instant) -> Option<usize> {
        let is_waiting = |entry: &ConnectionEntry| entry.standing == ConnectionStanding::Waiting;
        let mut waiting = BTreeMap::<IpAddr, usize>::new();
        for entry in entries.iter().filter(|entry| is_waiting(entry)) {
            *waiting.entry(entry.address).or_default() += 1;
        }
        let crowd = waiting.values().copied().max().unwrap_or_default();
        let is_replaceable = |entry: &ConnectionEntry| match (only, entry.standing) {
            (Some(address), _) if address != entry.address => false,
            (Some(_), ConnectionStanding::Waiting) => true,
            (None, ConnectionStanding::Waiting) => waiting.get(&entry.address) == Some(&crowd),
            (_, ConnectionStanding::Admitted) => now.saturating_duration_since(entry.heard) >= self.limits.silence,
            (_, ConnectionStanding::Reserved) => false,
        };
        let candidates = entries.iter().enumerate().filter(|(_, entry)| is_replaceable(entry));
        // Connections that wait for admission are replaced before admitted connections.
        candidates.min_by_key(|(_, entry)| (!is_waiting(entry), entry.heard)).map(|(index, _)| index)
    }
}

impl ConnectionHandle {
    /// Records that data arrived on the network connection.
    pub fn heard(&self, now: Instant) {
        self.change(|entry| entry.heard = now);
    }

    /// Admits the connection if the limits of admitted connections leave room; returns whether the connection is
    /// admitted.
    #[must_use]
    pub fn admit(&self) -> bool {
        let limits = self.table.limits;
        let mut inner = lock(&self.table.inner);
        let is_admitted = |entry: &&ConnectionEntry| entry.standing == ConnectionStanding::Admitted;
        let others = inner.entries.iter().filter(is_admitted).filter(|entry| entry.number != self.number);
        let of_address = others.clone().filter(|entry| entry.address == self.address).count();
        let has_room = others.count() < limits.admitted && of_address < limits.admitted_per_address;
        let Some(entry) = inner.entries.iter_mut().find(|entry| entry.number == self.number) else { return false };
        if entry.standing == ConnectionStanding::Waiting && has_room {
            entry.standing = ConnectionStanding::Admitted;
        }
        entry.standing != ConnectionStanding::Waiting
    }

    /// Reserves the connection's entry, or turns a reserved entry into an admitted entry.
    pub fn reserve(&self, is_reserved: bool) {
        self.change(|entry| match (is_reserved, entry.standing) {
            (true, _) => entry.standing = ConnectionStanding::Reserved,
            (false, ConnectionStanding::Reserved) => entry.standing = ConnectionStanding::Admitted,
            (false, _) => {}
        });
    }

    /// Completes when another connection replaces this one, which then has to be closed.
    pub fn closed(&self) -> impl Future<Output = ()> + use<> {
        let mut closing = self.closing.clone();
        async move {
            // An error means that the table entry no longer exists, which has the same consequence.
            let _ = closing.wait_for(|closing| *closing).await;
        }
    }

    fn change(&self, change: impl FnOnce(&mut ConnectionEntry)) {
        let mut inner = lock(&self.table.inner);
        if let Some(entry) = inner.entries.iter_mut().find(|entry| entry.number == self.number) {
            change(entry);
        }
    }
}

impl Drop for ConnectionHandle {
    fn drop(&mut self) {
        lock(&self.table.inner).entries.retain(|entry| entry.number != self.number);
    }
}

/// The network that the limits count as one address: an IPv4 address, or the /64 prefix of an IPv6 address, since one
/// site can use all addresses of such a prefix.
pub fn network_of(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V4(address) => address.into(),
        IpAddr::V6(address) => IpAddr::V6((address.to_bits() & !u128::from(u64::MAX)).into()),
    }
}
