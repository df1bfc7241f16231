//! The connections of a listener: who is let in, who gives way, who stays.

use std::net::IpAddr;
use std::time::{Duration, Instant};

use tomcom_devices::connection_table::{ConnectionHandle, ConnectionLimits, ConnectionTable, network_of};

use crate::support::*;

const LIMITS: ConnectionLimits = ConnectionLimits {
    most: 10,
    per_address: 4,
    admitted: 5,
    admitted_per_address: 2,
    silence: Duration::from_secs(5),
};

fn address(text: &str) -> IpAddr {
    text.parse().expect("an address")
}

/// A table, and connections that arrive a second after each other.
struct Arrivals {
    table: Arc<ConnectionTable>,
    now: Instant,
}

impl Arrivals {
    fn new() -> Arrivals {
        Arrivals { table: ConnectionTable::new(LIMITS), now: Instant::now() }
    }

    fn arrive(&mut self, from: &str) -> Option<ConnectionHandle> {
        self.now += Duration::from_secs(1);
        self.table.arrive(address(from), self.now).map(|arrival| arrival.place)
    }

    fn several(&mut self, from: &str, count: usize) -> Vec<ConnectionHandle> {
        (0..count).map(|_| self.arrive(from).expect("a place")).collect()
    }
}

/// Which of these have to give way.
async fn closed(places: &[ConnectionHandle]) -> Vec<usize> {
    let mut found = Vec::new();
    for (index, place) in places.iter().enumerate() {
        tokio::select! {
            biased;
            () = place.closed() => found.push(index),
            () = std::future::ready(()) => {}
        }
    }
    found
}

#[tokio::test]
async fn who_was_heard_of_last_stays() {
    let mut arrivals = Arrivals::new();
    let places = arrivals.several("10.0.0.1", 4);
    places[0].heard(arrivals.now + Duration::from_millis(1));
    arrivals.several("10.0.0.1", 1);
    assert_eq!(closed(&places).await, [1]);
}

#[tokio::test]
async fn what_was_admitted_stays_unless_it_is_silent_and_nothing_else_gives_way() {
    let mut arrivals = Arrivals::new();
    let pages = arrivals.several("10.0.0.1", 3);
    assert_eq!([pages[0].admit(), pages[1].admit(), pages[2].admit()], [true, true, false], "two of an address");
    assert!(pages[0].admit(), "it is admitted already");
    let _silent = arrivals.several("10.0.0.1", 10);
    assert_eq!(closed(&pages).await, [2]);
    // Where all of an address are admitted, who was silent for five seconds gives way.
    let limits = ConnectionLimits { admitted_per_address: 4, ..LIMITS };
    let mut arrivals = Arrivals { table: ConnectionTable::new(limits), now: Instant::now() };
    let trackers = arrivals.several("127.0.0.1", 4);
    assert!(trackers.iter().all(ConnectionHandle::admit));
    assert!(arrivals.arrive("127.0.0.1").is_none(), "they all sent something of late");
    trackers[1..].iter().for_each(|tracker| tracker.heard(arrivals.now + Duration::from_secs(4)));
    arrivals.now += Duration::from_secs(4);
    assert!(arrivals.arrive("127.0.0.1").is_some());
    assert_eq!(closed(&trackers).await, [0]);
}

#[test]
fn a_place_is_free_again_when_its_connection_ends() {
    let mut arrivals = Arrivals::new();
    let places = arrivals.several("10.0.0.1", 4);
    assert!(!arrivals.table.arrive(address("10.0.0.2"), arrivals.now).expect("a place").made_room);
    drop(places);
    assert!(!arrivals.table.arrive(address("10.0.0.1"), arrivals.now).expect("a place").made_room);
}

#[test]
fn a_network_counts_as_one_address() {
    assert_eq!(network_of(address("2001:db8:1:2:3:4:5:6")), address("2001:db8:1:2::"));
    assert_ne!(network_of(address("2001:db8:1:2::1")), network_of(address("2001:db8:1:3::1")));
    assert_eq!(network_of(address("::ffff:10.0.0.7")), address("10.0.0.7"));
    assert_eq!(network_of(address("10.0.0.7")), address("10.0.0.7"));
}
