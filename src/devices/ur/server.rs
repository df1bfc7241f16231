//! The simulated controller on the ports of a real one, in wall time.
//!
//! One task owns the controller and goes on with it; each connection has a task that reads and one that writes.

use std::collections::BTreeMap;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio::time::{Instant, interval_at, sleep};

use super::controller::{Series, SimulatedController};
use super::dashboard;
use super::faults::Fault;
use super::motion::CYCLE_S;
use super::rtde::RtdeConnection;
use super::script::ScriptGatherer;

/// Number of connections at a time.
const MOST_CONNECTIONS: usize = 64;
/// Number of messages that wait for a client; a client that reads none of them loses output packages.
const QUEUE: usize = 256;
/// Bytes that are read at a time.
const CHUNK: usize = 16 * 1024;
/// Lag behind the wall clock after which the controller lets the lost time go, in seconds: after the machine slept.
const MOST_LAG_S: f64 = 0.5;

#[derive(Clone, Copy)]
enum Interface {
    Dashboard,
    /// Primary, secondary and real-time interface, which take scripts.
    Script,
    Rtde,
}

/// The ports of a controller, in the order in which [`ControllerServer::addresses`] tells them: dashboard, primary,
/// secondary and real-time interface, RTDE.
pub const PORTS: [u16; 5] = [29_999, 30_001, 30_002, 30_003, 30_004];
const INTERFACES: [Interface; 5] =
    [Interface::Dashboard, Interface::Script, Interface::Script, Interface::Script, Interface::Rtde];

/// What a connection's tasks and the listeners tell.
enum News {
    Opened(Interface, TcpStream, SocketAddr),
    Bytes(u64, Vec<u8>),
    Closed(u64),
}

enum Talk {
    Dashboard(Vec<u8>),
    Script(ScriptGatherer),
    Rtde(RtdeConnection),
}

struct Connection {
    talk: Talk,
    answers: mpsc::Sender<Vec<u8>>,
    reader: JoinHandle<()>,
    from: SocketAddr,
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.reader.abort();
    }
}

/// The simulated controller, listening.
pub struct ControllerServer {
    controller: SimulatedController,
    listeners: Vec<TcpListener>,
}

impl ControllerServer {
    /// Listens at an address. A port 0 is any free one.
    ///
    /// # Errors
    /// The port that cannot be had, and why.
    pub async fn bind(
        address: IpAddr,
        ports: [u16; 5],
        controller: SimulatedController,
    ) -> Result<ControllerServer, (SocketAddr, io::Error)> {
        let mut listeners = Vec::new();
        for port in ports {
            let address = SocketAddr::new(address, port);
            listeners.push(TcpListener::bind(address).await.map_err(|error| (address, error))?);
        }
        Ok(ControllerServer { controller, listeners })
    }

    pub fn addresses(&self) -> Vec<SocketAddr> {
        self.listeners.iter().filter_map(|listener| listener.local_addr().ok()).collect()
    }

    /// Serves until the sender of faults is gone. `tell` gets lines for the person beside the controller.
    pub async fn run(self, mut faults: mpsc::Receiver<Fault>, tell: impl FnMut(&str)) {
        let (sender, mut news) = mpsc::channel(QUEUE);
        for (interface, listener) in INTERFACES.into_iter().zip(self.listeners) {
            tokio::spawn(accept(interface, listener, sender.clone()));
        }
        let tick_s = if self.controller.series == Series::E { 0.002 } else { CYCLE_S };
        let mut service = Service {
            controller: self.controller,
            connections: BTreeMap::new(),
            last: 0,
            ticks: 0,
            ticks_a_cycle: (CYCLE_S / tick_s).round() as u64,
            closed_until: Instant::now(),
            delay_ms: Arc::new(AtomicU64::new(0)),
            sender,
            tell,
        };
        let tick = Duration::from_secs_f64(tick_s);
        let mut clock = interval_at(Instant::now() + tick, tick);
        loop {
            tokio::select! {
                due = clock.tick() => {
                    if due.elapsed().as_secs_f64() > MOST_LAG_S {
                        clock.reset();
                    }
                    service.tick();
                }
                Some(one) = news.recv() => service.take(one),
                fault = faults.recv() => match fault {
                    Some(fault) => service.happen(fault),
                    None => return,
                },
            }
        }
    }
}

async fn accept(interface: Interface, listener: TcpListener, news: mpsc::Sender<News>) {
    loop {
        match listener.accept().await {
            Ok((stream, from)) => {
                if news.send(News::Opened(interface, stream, from)).await.is_err() {
                    return;
                }
            }
            // Out of file descriptors, say: a client tries again.
            Err(_) => sleep(Duration::from_millis(100)).await,
        }
    }
}

struct Service<Tell> {
    controller: SimulatedController,
    connections: BTreeMap<u64, Connection>,
    /// The number of the last connection.
    last: u64,
    ticks: u64,
    ticks_a_cycle: u64,
    closed_until: Instant,
    delay_ms: Arc<AtomicU64>,
    sender: mpsc::Sender<News>,
    tell: Tell,
}

impl<Tell: FnMut(&str)> Service<Tell> {
    fn tick(&mut self) {
        let part = self.ticks % self.ticks_a_cycle;
        self.ticks += 1;
        if part == 0 {
            self.controller.cycle();
            self.pass_messages();
        }
        let share = (part + 1) as f64 / self.ticks_a_cycle as f64;
        for connection in self.connections.values_mut() {
            let Talk::Rtde(rtde) = &mut connection.talk else { continue };
            let bytes = rtde.outputs(&self.controller, share);
            if !bytes.is_empty() {
                // As on the real controller, a client that is too slow misses packages.
                let _ = connection.answers.try_send(bytes);
            }
        }
    }

    fn pass_messages(&mut self) {
        for message in self.controller.take_messages() {
            (self.tell)(&format!("{:.3} s {}: {}", self.controller.now_s(), message.level, message.text));
            for connection in self.connections.values() {
                let Talk::Rtde(rtde) = &connection.talk else { continue };
                if let Some(bytes) = rtde.message(&message) {
                    let _ = connection.answers.try_send(bytes);
                }
            }
        }
    }

    fn happen(&mut self, fault: Fault) {
        match fault {
            Fault::Disconnect(seconds) => {
                let all: Vec<u64> = self.connections.keys().copied().collect();
                all.into_iter().for_each(|id| self.close(id));
                self.closed_until = Instant::now() + Duration::from_secs_f64(seconds);
            }
            Fault::Slow(seconds) => self.delay_ms.store((seconds * 1000.0) as u64, Ordering::Relaxed),
            other => other.happen(&mut self.controller),
        }
        self.pass_messages();
    }

    fn take(&mut self, news: News) {
        match news {
            News::Opened(interface, stream, from) => self.open(interface, stream, from),
            News::Bytes(id, bytes) => self.answer(id, &bytes),
            News::Closed(id) => self.close(id),
        }
        self.pass_messages();
    }

    fn open(&mut self, interface: Interface, stream: TcpStream, from: SocketAddr) {
        if Instant::now() < self.closed_until || self.connections.len() >= MOST_CONNECTIONS {
            return;
        }
        self.last += 1;
        let id = self.last;
        let (answers, queue) = mpsc::channel(QUEUE);
        let talk = match interface {
            Interface::Dashboard => {
                let _ = answers.try_send(format!("{}\n", dashboard::GREETING).into_bytes());
                Talk::Dashboard(Vec::new())
            }
            Interface::Script => Talk::Script(ScriptGatherer::default()),
            Interface::Rtde => Talk::Rtde(RtdeConnection::new(id)),
        };
        // Small packages go out at once; without that the connection works as well.
        let _ = stream.set_nodelay(true);
        let (from_client, to_client) = stream.into_split();
        tokio::spawn(write(to_client, queue, Arc::clone(&self.delay_ms)));
        let reader = tokio::spawn(read(id, from_client, self.sender.clone(), Arc::clone(&self.delay_ms)));
        self.connections.insert(id, Connection { talk, answers, reader, from });
    }

    fn close(&mut self, id: u64) {
        if let Some(connection) = self.connections.remove(&id)
            && let Talk::Rtde(rtde) = &connection.talk
        {
            rtde.leave(&mut self.controller);
        }
    }

    fn answer(&mut self, id: u64, bytes: &[u8]) {
        let Some(connection) = self.connections.get_mut(&id) else { return };
        let (controller, from) = (&mut self.controller, connection.from);
        let mut answers = Vec::new();
        let over = match &mut connection.talk {
            Talk::Dashboard(line) => command_lines(line, bytes, controller, &mut answers),
            Talk::Script(gatherer) => {
                let scripts = gatherer.take(bytes);
                scripts.iter().flatten().for_each(|script| _ = controller.run_script(script));
                scripts.err().map(|error| error.to_string())
            }
            Talk::Rtde(rtde) => {
                rtde.take(bytes, controller).map(|found| answers = found).err().map(|fault| fault.to_string())
            }
        };
        // A client that leaves so much unread is not waited for.
        let is_stuck = !answers.is_empty() && connection.answers.try_send(answers).is_err();
        let over = over.or_else(|| is_stuck.then(|| "it reads nothing".to_string()));
        if let Some(why) = over {
            if !why.is_empty() {
                (self.tell)(&format!("{from} is disconnected: {why}"));
            }
            self.close(id);
        }
    }
}

/// Answers the dashboard's commands in these bytes; why the connection ends, where it does, in words that are empty for
/// `quit`.
fn command_lines(
    line: &mut Vec<u8>,
    bytes: &[u8],
    controller: &mut SimulatedController,
    answers: &mut Vec<u8>,
) -> Option<String> {
    for &byte in bytes {
        if byte != b'\n' {
            line.push(byte);
            if line.len() > dashboard::MOST_BYTES {
                return Some(format!("a command of more than {} bytes", dashboard::MOST_BYTES));
            }
            continue;
        }
        let command = String::from_utf8_lossy(&std::mem::take(line)).into_owned();
        let answer = dashboard::answer(&command, controller);
        answers.extend(answer.as_deref().unwrap_or(dashboard::GOODBYE).as_bytes());
        answers.push(b'\n');
        if answer.is_none() {
            return Some(String::new());
        }
    }
    None
}

async fn read(id: u64, mut from: tokio::net::tcp::OwnedReadHalf, news: mpsc::Sender<News>, delay_ms: Arc<AtomicU64>) {
    let mut chunk = vec![0; CHUNK];
    loop {
        let count = from.read(&mut chunk).await.unwrap_or(0);
        wait(&delay_ms).await;
        let told = if count == 0 { News::Closed(id) } else { News::Bytes(id, chunk[..count].to_vec()) };
        if news.send(told).await.is_err() || count == 0 {
            return;
        }
    }
}

/// Writes until the connection is dropped, and then what was still to be written.
async fn write(mut to: tokio::net::tcp::OwnedWriteHalf, mut queue: mpsc::Receiver<Vec<u8>>, delay_ms: Arc<AtomicU64>) {
    while let Some(mut bytes) = queue.recv().await {
        wait(&delay_ms).await;
        while let Ok(more) = queue.try_recv() {
            bytes.extend(more);
        }
        if to.write_all(&bytes).await.is_err() {
            return;
        }
    }
}

async fn wait(delay_ms: &AtomicU64) {
    let delay_ms = delay_ms.load(Ordering::Relaxed);
    if delay_ms > 0 {
        sleep(Duration::from_millis(delay_ms)).await;
    }
}
