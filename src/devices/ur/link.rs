//! The driver on the ports of a controller, in wall time: connects, exchanges packages, and connects again.
//!
//! It has a thread of its own, so that a busy console delays no heartbeat. Its orders come 20 times a second; without them
//! the arm stands.

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::time::Duration;

use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::net::TcpStream;
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep, timeout, timeout_at};
use tomcom_arm::real_arm::ArmOrder;
use tomcom_core::robot::ArmStage;
use tomcom_session::Event;
use tomcom_session::preflight_checks::PreflightCheck;

use super::client::{ClientNews, RtdeClient};
use super::dashboard;
use super::driver::{ArmIdentity, DriverAction, PROGRAM, UrDriver};

/// Longest wait for a connection or an answer, and between two packages.
const ANSWERS_WITHIN: Duration = Duration::from_secs(2);
const SILENT: Duration = Duration::from_millis(500);
/// Time after a lost connection before the next one is tried.
const AGAIN_AFTER: Duration = Duration::from_secs(1);
/// Time without an order after which the arm stands.
const ORDERED_WITHIN: Duration = Duration::from_millis(500);
/// How long the connection that brings the program stays open.
const UPLOADS_FOR: Duration = Duration::from_millis(500);
/// Bytes that are read at a time.
const CHUNK: usize = 16 * 1024;
/// Number of commands for the dashboard server that wait.
const COMMANDS: usize = 16;

/// What a session wants of the driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArmCommand {
    /// A recording begins.
    Begin,
    Order(ArmOrder),
    Confirm(ArmStage),
    Stop,
}

/// What the driver tells.
#[derive(Clone, Debug, PartialEq)]
pub enum ArmNews {
    /// For the session.
    Event(Box<Event>),
    /// The checks of arm and controller, whenever they change.
    Checks(Vec<PreflightCheck>),
    /// What the controller says, in its words.
    Message(String),
}

/// A running driver. It ends, and the arm stops by itself, when this and all its orders are dropped.
pub struct UrConnection {
    pub orders: ArmOrders,
    news: mpsc::UnboundedReceiver<ArmNews>,
}

/// What a recording tells the driver.
#[derive(Clone)]
pub struct ArmOrders(mpsc::UnboundedSender<ArmCommand>);

impl ArmOrders {
    /// A recording begins: the driver tells how far the arm is.
    pub fn begin(&self) {
        self.send(ArmCommand::Begin);
    }

    /// Repeats what the arm is to do now. Without that, it soon stands.
    pub fn order(&self, order: ArmOrder) {
        self.send(ArmCommand::Order(order));
    }

    /// Carries out an event of the recording, where it is about the arm.
    pub fn tell(&self, event: &Event) {
        match event {
            Event::RobotConfirmed { stage } => self.send(ArmCommand::Confirm(*stage)),
            Event::RobotResumed => self.send(ArmCommand::Confirm(ArmStage::Stopped)),
            Event::RobotStopped => self.send(ArmCommand::Stop),
            _ => {}
        }
    }

    fn send(&self, command: ArmCommand) {
        // The driver's thread ends only with its orders.
        let _ = self.0.send(command);
    }
}

impl UrConnection {
    /// Starts the driver for a controller with these ports, in the order of [`super::server::PORTS`].
    ///
    /// # Errors
    /// There is no thread for it.
    pub fn start(address: IpAddr, ports: [u16; 5], driver: UrDriver) -> io::Result<UrConnection> {
        let (commands, orders) = mpsc::unbounded_channel();
        let (tell, news) = mpsc::unbounded_channel();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let [dashboard, _, script, _, rtde] = ports.map(|port| SocketAddr::new(address, port));
        let shown = Vec::new();
        let service = Service { dashboard, script, rtde, driver, orders, tell, shown, began: Instant::now() };
        std::thread::Builder::new().name("arm".to_string()).spawn(move || runtime.block_on(service.run()))?;
        Ok(UrConnection { orders: ArmOrders(commands), news })
    }

    /// Waits for the next news.
    pub async fn next(&mut self) -> Option<ArmNews> {
        self.news.recv().await
    }
}

/// Checks a controller without moving its arm.
///
/// # Errors
/// It does not answer, or not as the controller of a UR5 does.
pub async fn examine(address: IpAddr, ports: [u16; 5], mut driver: UrDriver) -> Result<Vec<PreflightCheck>, String> {
    let [dashboard, _, _, _, rtde] = ports.map(|port| SocketAddr::new(address, port));
    driver.introduce(Dashboard::connect(dashboard).await?.identity().await?);
    let (mut stream, mut client) = (connect(rtde).await?, RtdeClient::default());
    let (mut send, mut chunk) = (RtdeClient::hello(), vec![0; CHUNK]);
    let due = Instant::now() + ANSWERS_WITHIN;
    loop {
        stream.write_all(&send).await.map_err(lost)?;
        let read = timeout_at(due, stream.read(&mut chunk)).await;
        let count = read.map_err(|_| format!("no answer at {rtde}"))?.map_err(lost)?;
        if count == 0 {
            return Err("the controller has closed the connection".to_string());
        }
        let (next, news) = client.take(&chunk[..count]).map_err(|fault| fault.to_string())?;
        for one in news {
            if let ClientNews::Reading(reading) = one {
                driver.step(&reading, 0.0);
                return Ok(driver.checks());
            }
        }
        send = next;
    }
}

/// The session has left.
struct Left;

struct Service {
    dashboard: SocketAddr,
    script: SocketAddr,
    rtde: SocketAddr,
    driver: UrDriver,
    orders: mpsc::UnboundedReceiver<ArmCommand>,
    tell: mpsc::UnboundedSender<ArmNews>,
    /// The checks that were told last.
    shown: Vec<PreflightCheck>,
    began: Instant,
}

impl Service {
    async fn run(mut self) {
        loop {
            let lost = match self.connect_and_drive().await {
                Ok(Left) => return,
                Err(why) => why,
            };
            let actions = self.driver.lose(&lost);
            self.pass(actions, None);
            // What is ordered without a connection is too late with one.
            let again = sleep(AGAIN_AFTER);
            tokio::pin!(again);
            loop {
                tokio::select! {
                    () = &mut again => break,
                    command = self.orders.recv() => match command {
                        Some(command) => {
                            self.take(command);
                            let actions = self.driver.lose(&lost);
                            self.pass(actions, None);
                        }
                        None => return,
                    },
                }
            }
        }
    }

    async fn connect_and_drive(&mut self) -> Result<Left, String> {
        let mut dashboard = Dashboard::connect(self.dashboard).await?;
        self.driver.introduce(dashboard.identity().await?);
        let (commands, queue) = mpsc::channel(COMMANDS);
        let serves = tokio::spawn(dashboard.serve(queue, self.tell.clone()));
        let driven = self.drive(&commands).await;
        serves.abort();
        driven
    }

    async fn drive(&mut self, dashboard: &mpsc::Sender<&'static str>) -> Result<Left, String> {
        let mut stream = connect(self.rtde).await?;
        let mut client = RtdeClient::default();
        stream.write_all(&RtdeClient::hello()).await.map_err(lost)?;
        let mut chunk = vec![0; CHUNK];
        let mut heard = Instant::now();
        let mut ordered = Instant::now();
        loop {
            tokio::select! {
                read = timeout_at(heard + SILENT, stream.read(&mut chunk)) => {
                    let count = match read {
                        Ok(read) => read.map_err(lost)?,
                        Err(_) => return Err(format!("the controller was silent for {:.1} s", SILENT.as_secs_f64())),
                    };
                    if count == 0 {
                        return Err("the controller has closed the connection".to_string());
                    }
                    heard = Instant::now();
                    let (mut send, news) = client.take(&chunk[..count]).map_err(|fault| fault.to_string())?;
                    if ordered.elapsed() > ORDERED_WITHIN {
                        self.driver.stand();
                    }
                    for one in news {
                        if let ClientNews::Reading(reading) = one {
                            let actions = self.driver.step(&reading, self.began.elapsed().as_secs_f64());
                            self.pass(actions, Some(dashboard));
                            send.extend(client.inputs(&self.driver.inputs()));
                        } else if let ClientNews::Message(words) = one {
                            let _ = self.tell.send(ArmNews::Message(words));
                        }
                    }
                    let written = timeout(SILENT, stream.write_all(&send)).await;
                    written.map_err(|_| "the controller takes nothing".to_string())?.map_err(lost)?;
                }
                command = self.orders.recv() => match command {
                    Some(command) => {
                        ordered = Instant::now();
                        self.take(command);
                    }
                    None => return Ok(Left),
                },
            }
        }
    }

    fn take(&mut self, command: ArmCommand) {
        match command {
            ArmCommand::Begin => {
                self.shown.clear();
                self.driver.begin();
            }
            ArmCommand::Order(order) => self.driver.order(order),
            ArmCommand::Confirm(stage) => self.driver.confirm(stage),
            ArmCommand::Stop => self.driver.stop(),
        }
    }

    fn pass(&mut self, actions: Vec<DriverAction>, dashboard: Option<&mpsc::Sender<&'static str>>) {
        for action in actions {
            match action {
                DriverAction::Tell(event) => {
                    let _ = self.tell.send(ArmNews::Event(event));
                }
                DriverAction::Dashboard(command) => {
                    // With so many commands unanswered the connection is as good as lost, which its task tells.
                    let _ = dashboard.map(|dashboard| dashboard.try_send(command));
                }
                DriverAction::Upload => {
                    tokio::spawn(upload(self.script, self.tell.clone()));
                }
            }
        }
        let checks = self.driver.checks();
        if checks != self.shown {
            self.shown.clone_from(&checks);
            let _ = self.tell.send(ArmNews::Checks(checks));
        }
    }
}

fn lost(error: io::Error) -> String {
    format!("the connection is lost: {error}")
}

async fn connect(address: SocketAddr) -> Result<TcpStream, String> {
    let stream = timeout(ANSWERS_WITHIN, TcpStream::connect(address)).await;
    let stream = stream.map_err(|_| format!("no answer at {address}"))?;
    let stream = stream.map_err(|error| format!("no connection to {address}: {error}"))?;
    // Small packages go out at once; without that the connection works as well.
    let _ = stream.set_nodelay(true);
    Ok(stream)
}

/// Lets the controller run the program.
async fn upload(address: SocketAddr, tell: mpsc::UnboundedSender<ArmNews>) {
    let sent = async {
        let mut stream = connect(address).await?;
        stream.write_all(PROGRAM.as_bytes()).await.map_err(|error| format!("{address}: {error}"))?;
        sleep(UPLOADS_FOR).await;
        Ok::<(), String>(())
    };
    if let Err(why) = sent.await {
        let _ = tell.send(ArmNews::Message(why));
    }
}

/// A connection to the dashboard server: a line there, a line back.
struct Dashboard(BufReader<TcpStream>);

impl Dashboard {
    async fn connect(address: SocketAddr) -> Result<Dashboard, String> {
        let mut dashboard = Dashboard(BufReader::new(connect(address).await?));
        let greeting = dashboard.line().await?;
        if greeting != dashboard::GREETING {
            return Err(format!("at {address} there is no dashboard server of a UR: it says {greeting:?}"));
        }
        Ok(dashboard)
    }

    async fn identity(&mut self) -> Result<ArmIdentity, String> {
        let software = self.ask("PolyscopeVersion").await?;
        let software = software.strip_prefix("URSoftware ").unwrap_or(&software).to_string();
        let model = self.ask("get robot model").await?;
        let is_remote = match self.ask("is in remote control").await?.as_str() {
            "true" => Some(true),
            "false" => Some(false),
            _ => None,
        };
        Ok(ArmIdentity { model, software, is_remote })
    }

    async fn ask(&mut self, command: &str) -> Result<String, String> {
        let lost = |error: io::Error| format!("the dashboard server is lost: {error}");
        self.0.write_all(format!("{command}\n").as_bytes()).await.map_err(lost)?;
        self.line().await
    }

    async fn line(&mut self) -> Result<String, String> {
        let mut line = Vec::new();
        let most = dashboard::MOST_BYTES as u64;
        let read = timeout(ANSWERS_WITHIN, (&mut self.0).take(most).read_until(b'\n', &mut line)).await;
        let count = read.map_err(|_| "the dashboard server does not answer".to_string())?;
        match count {
            Ok(1..) => Ok(String::from_utf8_lossy(&line).trim().to_string()),
            Ok(0) => Err("the dashboard server has closed the connection".to_string()),
            Err(error) => Err(format!("the dashboard server is lost: {error}")),
        }
    }

    /// Passes commands on, until there are no more.
    async fn serve(mut self, mut commands: mpsc::Receiver<&'static str>, tell: mpsc::UnboundedSender<ArmNews>) {
        while let Some(command) = commands.recv().await {
            if let Err(why) = self.ask(command).await {
                let _ = tell.send(ArmNews::Message(why));
                return;
            }
        }
    }
}
