//! A page of the program as raw bytes: tests of the library and of the program speak with servers as browsers do.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use serde_json::{Value, json};

/// Nothing that is waited for takes longer; that it does not come is the failure.
const PATIENCE: Duration = Duration::from_secs(300);

pub fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).expect("connected");
    stream.set_read_timeout(Some(PATIENCE)).expect("a time-out");
    stream
}

/// A page, as far as the server can see.
pub struct RawPage(pub TcpStream);

impl RawPage {
    pub fn open(stream: TcpStream, host: SocketAddr) -> RawPage {
        let mut page = RawPage(stream);
        page.0.set_read_timeout(Some(PATIENCE)).expect("a time-out");
        let request = format!(
            "GET /talk HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        );
        page.0.write_all(request.as_bytes()).expect("sent");
        let mut head = Vec::new();
        while !head.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            page.0.read_exact(&mut byte).expect("an answer");
            head.push(byte[0]);
        }
        assert!(head.starts_with(b"HTTP/1.1 101"), "{}", String::from_utf8_lossy(&head));
        page
    }

    /// A text frame as browsers send it (RFC 6455, section 5.2); with a mask of zeros.
    pub fn say(&mut self, message: &Value) {
        let text = message.to_string();
        let mut frame = vec![0x81, 0x80 | 126];
        frame.extend((text.len() as u16).to_be_bytes());
        frame.extend([0; 4]);
        frame.extend(text.as_bytes());
        // Who was thrown out already is told so by what it hears.
        let _ = self.0.write_all(&frame);
    }

    /// The next message of this kind; none, if the connection ends before.
    pub fn hear(&mut self, kind: &str) -> Option<Value> {
        self.hear_one_of(&[kind])
    }

    pub fn hear_one_of(&mut self, kinds: &[&str]) -> Option<Value> {
        loop {
            let mut head = [0; 2];
            self.0.read_exact(&mut head).ok()?;
            let length = match head[1] {
                126 => {
                    let mut length = [0; 2];
                    self.0.read_exact(&mut length).ok()?;
                    usize::from(u16::from_be_bytes(length))
                }
                127 => {
                    let mut length = [0; 8];
                    self.0.read_exact(&mut length).ok()?;
                    u64::from_be_bytes(length) as usize
                }
                short => usize::from(short),
            };
            let mut payload = vec![0; length];
            self.0.read_exact(&mut payload).ok()?;
            // Pings are answered by browsers; this one is not there for so long.
            if head[0] != 0x81 {
                continue;
            }
            let message: Value = serde_json::from_slice(&payload).expect("JSON");
            if kinds.iter().any(|kind| message["kind"] == *kind) {
                return Some(message);
            }
        }
    }
}

pub fn page(address: SocketAddr) -> RawPage {
    RawPage::open(connect(address), address)
}

/// The page of an observer, with the lines that it shows.
pub struct RawObserver {
    pub page: RawPage,
    lines: Vec<String>,
}

impl RawObserver {
    pub fn open(address: SocketAddr) -> RawObserver {
        RawObserver { page: page(address), lines: Vec::new() }
    }

    pub fn hello(&mut self, page: &str, observer: &str, code: Option<&str>) {
        self.page.say(&json!({"kind": "hello", "page": page, "observer": observer, "code": code}));
    }

    /// Says hello; the kind of what is answered: `welcome`, `full` or `pairing`.
    pub fn joins(&mut self, page: &str, observer: &str, code: Option<&str>) -> Option<String> {
        self.hello(page, observer, code);
        let answer = self.page.hear_one_of(&["welcome", "full", "pairing"])?;
        answer["kind"].as_str().map(str::to_string)
    }

    /// Takes the frames that have come; the screen, without blanks at the ends of lines.
    pub fn screen(&mut self) -> String {
        self.page.say(&json!({"kind": "ping", "t": 1.0}));
        loop {
            let message = self.page.hear_one_of(&["frame", "pong"]).expect("the server is there");
            if message["kind"] == "pong" {
                return self.lines.join("\n").trim_end().to_string();
            }
            self.lines.resize(message["rows"].as_u64().expect("a number") as usize, String::new());
            for line in message["lines"].as_array().expect("lines") {
                let runs = line[1].as_array().expect("runs");
                let text: String = runs.iter().filter_map(|run| run["text"].as_str()).collect();
                self.lines[line[0].as_u64().expect("an index") as usize] = text.trim_end().to_string();
            }
        }
    }
}
