//! The part of ZeroMQ's wire protocol (ZMTP 3.0, <https://rfc.zeromq.org/spec/23/>, without security) that the
//! connection to Pupil Capture needs. Memory use is bounded: memory is allocated for bytes that have been received,
//! never for lengths that the other side claims.

use std::io;
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;

/// A ZeroMQ message, as a list of its frames.
pub type ZmtpMessage = Vec<Vec<u8>>;

/// Longest ZeroMQ message, in bytes of all frames, and largest number of frames.
const MAX_MESSAGE: usize = 1 << 20;
const MAX_FRAMES: usize = 16;
/// Time limit for replies that the other side of the connection can give at once.
const PATIENCE: Duration = Duration::from_secs(2);
const GREETING: usize = 64;

const MORE: u8 = 1;
const LONG: u8 = 2;
const COMMAND: u8 = 4;

/// Role of a ZeroMQ socket.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::IntoStaticStr)]
#[strum(serialize_all = "UPPERCASE")]
pub enum SocketRole {
    /// Request socket of ZeroMQ: sends requests and receives replies.
    Req,
    /// Subscriber socket of ZeroMQ: receives subscribed messages.
    Sub,
    /// Publisher socket of ZeroMQ: sends messages to subscribers.
    Pub,
}

fn broken(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// Assembles ZeroMQ messages from received bytes.
#[derive(Debug, Default)]
pub struct ZmtpFrameAssembler {
    bytes: Vec<u8>,
    /// Number of received bytes that have been consumed already.
    read: usize,
    frames: ZmtpMessage,
    size: usize,
}

impl ZmtpFrameAssembler {
    /// Adds bytes received from the ZeroMQ socket.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.drain(..self.read);
        self.read = 0;
        self.bytes.extend_from_slice(bytes);
    }

    /// The next complete ZeroMQ message; commands of the protocol are skipped.
    ///
    /// # Errors
    /// The bytes are no ZeroMQ message, or the message is too large.
    pub fn next_message(&mut self) -> io::Result<Option<ZmtpMessage>> {
        while let Some((flags, body)) = self.next_frame()? {
            if flags & COMMAND != 0 {
                continue;
            }
            self.size += body.len();
            self.frames.push(body);
            if self.size > MAX_MESSAGE || self.frames.len() > MAX_FRAMES {
                return Err(broken("a message that is too large"));
            }
            if flags & MORE == 0 {
                self.size = 0;
                return Ok(Some(std::mem::take(&mut self.frames)));
            }
        }
        Ok(None)
    }

    fn next_frame(&mut self) -> io::Result<Option<(u8, Vec<u8>)>> {
        let left = &self.bytes[self.read..];
        let Some(&flags) = left.first() else { return Ok(None) };
        if flags & !(MORE | LONG | COMMAND) != 0 {
            return Err(broken("a frame of another protocol"));
        }
        let sized = match flags & LONG != 0 {
            false => left.get(1).map(|length| (u64::from(*length), 2)),
            true => left[1..].first_chunk().map(|bytes| (u64::from_be_bytes(*bytes), 9)),
        };
        let Some((length, head)) = sized else { return Ok(None) };
        let length = usize::try_from(length).ok().filter(|&length| length <= MAX_MESSAGE);
        let length = length.ok_or_else(|| broken("a frame that is too large"))?;
        let Some(body) = left.get(head..head + length) else { return Ok(None) };
        let body = body.to_vec();
        self.read += head + length;
        Ok(Some((flags, body)))
    }
}

/// A connection to a ZeroMQ socket of another program.
#[derive(Debug)]
pub struct ZmtpConnection {
    stream: TcpStream,
    inbox: ZmtpFrameAssembler,
    chunk: Vec<u8>,
}

impl ZmtpConnection {
    /// Connects to a ZeroMQ socket and performs the handshake.
    ///
    /// # Errors
    /// Nothing listens at the address, or the other side does not speak the protocol.
    pub async fn open(address: &str, port: u16, role: SocketRole) -> io::Result<ZmtpConnection> {
        let late = |_| io::Error::new(io::ErrorKind::TimedOut, "no answer");
        timeout(PATIENCE, ZmtpConnection::agree(address, port, role)).await.map_err(late)?
    }

    async fn agree(address: &str, port: u16, role: SocketRole) -> io::Result<ZmtpConnection> {
        let mut stream = TcpStream::connect((address, port)).await?;
        stream.set_nodelay(true)?;
        let mut greeting = [0u8; GREETING];
        (greeting[0], greeting[9], greeting[10]) = (0xff, 0x7f, 3);
        greeting[12..16].copy_from_slice(b"NULL");
        stream.write_all(&greeting).await?;
        let mut theirs = [0u8; GREETING];
        stream.read_exact(&mut theirs).await?;
        if theirs[0] != 0xff || theirs[9] & 1 != 1 || theirs[10] < 3 {
            return Err(broken("another protocol than ZMTP 3"));
        }
        if theirs[12..32] != greeting[12..32] {
            return Err(broken("a server that asks for passwords"));
        }
        let mut ready = b"\x05READY".to_vec();
        ready.extend(property("Socket-Type", role.into()));
        if role == SocketRole::Req {
            ready.extend(property("Identity", ""));
        }
        stream.write_all(&[&[COMMAND, ready.len() as u8], ready.as_slice()].concat()).await?;
        let mut connection = ZmtpConnection { stream, inbox: ZmtpFrameAssembler::default(), chunk: vec![0; 1 << 16] };
        // The READY command of the other side comes before anything else.
        loop {
            match connection.inbox.next_frame()? {
                Some((flags, body)) if body.starts_with(b"\x05READY") && flags & COMMAND != 0 => return Ok(connection),
                Some(_) => return Err(broken("a server that refuses")),
                None => connection.fill().await?,
            }
        }
    }

    async fn fill(&mut self) -> io::Result<()> {
        match self.stream.read(&mut self.chunk).await? {
            0 => Err(io::Error::new(io::ErrorKind::UnexpectedEof, "it ended")),
            count => {
                self.inbox.push(&self.chunk[..count]);
                Ok(())
            }
        }
    }

    /// Waits for the next ZeroMQ message; a cancelled wait loses no bytes (cancel safe).
    ///
    /// # Errors
    /// The connection ended, or the bytes are no ZeroMQ message.
    pub async fn receive(&mut self) -> io::Result<ZmtpMessage> {
        loop {
            if let Some(message) = self.inbox.next_message()? {
                return Ok(message);
            }
            self.fill().await?;
        }
    }

    /// Sends a ZeroMQ message.
    ///
    /// # Errors
    /// The connection ended, or the other side accepts no data.
    pub async fn send(&mut self, frames: &[&[u8]]) -> io::Result<()> {
        let mut bytes = Vec::new();
        for (index, frame) in frames.iter().enumerate() {
            let more = if index + 1 < frames.len() { MORE } else { 0 };
            match u8::try_from(frame.len()) {
                Ok(length) => bytes.extend([more, length]),
                Err(_) => {
                    bytes.push(more | LONG);
                    bytes.extend((frame.len() as u64).to_be_bytes());
                }
            }
            bytes.extend_from_slice(frame);
        }
        let late = |_| io::Error::new(io::ErrorKind::TimedOut, "it takes nothing");
        timeout(PATIENCE, self.stream.write_all(&bytes)).await.map_err(late)?
    }

    /// Subscribes to ZeroMQ messages whose first frame has this prefix.
    ///
    /// # Errors
    /// The errors of [`ZmtpConnection::send`].
    pub async fn subscribe(&mut self, topic: &str) -> io::Result<()> {
        self.send(&[&[b"\x01", topic.as_bytes()].concat()]).await
    }

    /// Sends a request over ZeroMQ and waits for the reply.
    ///
    /// # Errors
    /// The errors of [`ZmtpConnection::send`], no reply in time, or a reply that is no text.
    pub async fn ask(&mut self, frames: &[&[u8]]) -> io::Result<String> {
        self.send(&[&[b"".as_slice()], frames].concat()).await?;
        let late = |_| io::Error::new(io::ErrorKind::TimedOut, "no answer");
        let answer = timeout(PATIENCE, self.receive()).await.map_err(late)??;
        let text = answer.into_iter().nth(1).and_then(|frame| String::from_utf8(frame).ok());
        text.ok_or_else(|| broken("an answer that is no text"))
    }
}

/// A property in ZeroMQ's READY command, as bytes.
fn property(name: &str, value: &str) -> Vec<u8> {
    let mut bytes = vec![name.len() as u8];
    bytes.extend(name.as_bytes());
    bytes.extend((value.len() as u32).to_be_bytes());
    bytes.extend(value.as_bytes());
    bytes
}
